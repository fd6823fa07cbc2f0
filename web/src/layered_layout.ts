// SPDX-License-Identifier: Apache-2.0
// Layout of a directed graph in columns from left to right. Edges of cycles lead back to the left.

export interface Size {
  width: number;
  height: number;
}

export interface Point {
  x: number;
  y: number;
}

export interface GraphEdge {
  from: number;
  to: number;
}

export interface GraphLayout {
  nodes: Point[]; // top left corners
  edges: Point[][]; // from the right side of `from`, through the columns between, to the left side of `to`
  width: number;
  height: number;
}

const kColumnGap = 56;
const kRowGap = 18;

// Marks edges that close a cycle, in a search from the first node on.
function backEdges(count: number, edges: readonly GraphEdge[]): boolean[] {
  const state = new Array<number>(count).fill(0);
  const back = new Array<boolean>(edges.length).fill(false);
  const visit = (node: number) => {
    state[node] = 1;
    edges.forEach((edge, index) => {
      if (edge.from !== node) return;
      if (state[edge.to] === 1) back[index] = true;
      else if (state[edge.to] === 0) visit(edge.to);
    });
    state[node] = 2;
  };
  for (let node = 0; node < count; ++node) if (state[node] === 0) visit(node);
  return back;
}

function longestPaths(count: number, edges: readonly GraphEdge[], back: readonly boolean[]): number[] {
  const layer = new Array<number>(count).fill(0);
  for (let round = 0; round < count; ++round) {
    let changed = false;
    edges.forEach((edge, index) => {
      if (back[index] || layer[edge.to]! > layer[edge.from]!) return;
      layer[edge.to] = layer[edge.from]! + 1;
      changed = true;
    });
    if (!changed) break;
  }
  return layer;
}

export function layoutGraph(sizes: readonly Size[], edges: readonly GraphEdge[]): GraphLayout {
  const back = backEdges(sizes.length, edges);
  const layer = longestPaths(sizes.length, edges, back);
  // An edge over several columns gets a bend in each of them.
  const boxes: (Size & { layer: number })[] = sizes.map((size, i) => ({ ...size, layer: layer[i]! }));
  const chains = edges.map((edge, index) => {
    if (back[index]) return [edge.from, edge.to];
    const chain = [edge.from];
    for (let l = layer[edge.from]! + 1; l < layer[edge.to]!; ++l) {
      boxes.push({ width: 0, height: 4, layer: l });
      chain.push(boxes.length - 1);
    }
    return [...chain, edge.to];
  });
  const columns: number[][] = [];
  boxes.forEach((box, i) => (columns[box.layer] ??= []).push(i));
  const before = boxes.map((): number[] => []);
  const after = boxes.map((): number[] => []);
  chains.forEach((chain, index) => {
    if (back[index]) return;
    for (let i = 0; i + 1 < chain.length; ++i) {
      after[chain[i]!]!.push(chain[i + 1]!);
      before[chain[i + 1]!]!.push(chain[i]!);
    }
  });
  const y = new Array<number>(boxes.length).fill(0);
  const stack = (column: readonly number[]) => {
    let at = 0;
    for (const i of column) {
      y[i] = at;
      at += boxes[i]!.height + kRowGap;
    }
  };
  const middle = (i: number) => y[i]! + boxes[i]!.height / 2;
  const mean = (nodes: readonly number[], otherwise: number) =>
    nodes.length === 0 ? otherwise : nodes.reduce((sum, node) => sum + middle(node), 0) / nodes.length;
  columns.forEach(stack);
  for (let sweep = 0; sweep < 6; ++sweep) {
    const forward = sweep % 2 === 0;
    const order = forward ? columns : [...columns].reverse();
    for (const column of order) {
      const wanted = new Map(column.map((i) => [i, mean(forward ? before[i]! : after[i]!, middle(i))]));
      column.sort((a, b) => wanted.get(a)! - wanted.get(b)! || a - b);
      stack(column);
    }
  }
  // Moves nodes toward their neighbors without changing the order.
  const total = Math.max(0, ...columns.map((column) => column.reduce((sum, i) => sum + boxes[i]!.height + kRowGap, -kRowGap)));
  for (const column of columns) {
    const height = column.reduce((sum, i) => sum + boxes[i]!.height + kRowGap, -kRowGap);
    for (const i of column) y[i] = y[i]! + (total - height) / 2;
  }
  for (let round = 0; round < 4; ++round)
    for (const column of round % 2 === 0 ? columns : [...columns].reverse()) {
      const wanted = column.map((i) => mean(round % 2 === 0 ? before[i]! : after[i]!, middle(i)) - boxes[i]!.height / 2);
      let at = -Infinity;
      column.forEach((i, k) => {
        y[i] = Math.max(at, wanted[k]!);
        at = y[i]! + boxes[i]!.height + kRowGap;
      });
    }
  const top = y.length > 0 ? Math.min(...y) : 0;
  const x: number[] = [];
  let left = 0;
  for (const column of columns) {
    x.push(left);
    left += Math.max(...column.map((i) => boxes[i]!.width)) + kColumnGap;
  }
  const place = (i: number): Point => ({ x: x[boxes[i]!.layer]!, y: y[i]! - top });
  const bottom = Math.max(0, ...boxes.map((box, i) => place(i).y + box.height));
  let loops = 0;
  const routes = chains.map((chain, index) => {
    const from = chain[0]!;
    const to = chain[chain.length - 1]!;
    const start = { x: place(from).x + boxes[from]!.width, y: place(from).y + boxes[from]!.height / 2 };
    const end = { x: place(to).x, y: place(to).y + boxes[to]!.height / 2 };
    if (!back[index]) return [start, ...chain.slice(1, -1).map((i) => ({ x: place(i).x, y: place(i).y + 2 })), end];
    const under = bottom + 14 + 10 * loops++;
    return [start, { x: start.x + 22, y: start.y }, { x: start.x + 22, y: under }, { x: end.x - 22, y: under }, { x: end.x - 22, y: end.y }, end];
  });
  return {
    nodes: sizes.map((_, i) => place(i)),
    edges: routes,
    width: Math.max(0, left - kColumnGap) + (loops > 0 ? 24 : 0),
    height: bottom + (loops > 0 ? 14 + 10 * loops : 0),
  };
}
