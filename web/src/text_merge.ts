// SPDX-License-Identifier: Apache-2.0
// Merges two versions of a text that have a common ancestor, by lines, for files that were edited on the page and on disk
// at the same time. Changes that touch the same lines are a conflict.

// Indices of the lines of a and b that a longest common subsequence pairs.
function commonLines(a: readonly string[], b: readonly string[]): [number, number][] {
  let head = 0;
  while (head < a.length && head < b.length && a[head] === b[head]) ++head;
  let tail = 0;
  while (tail < a.length - head && tail < b.length - head && a[a.length - 1 - tail] === b[b.length - 1 - tail]) ++tail;
  const n = a.length - head - tail;
  const m = b.length - head - tail;
  const pairs: [number, number][] = [];
  for (let i = 0; i < head; ++i) pairs.push([i, i]);
  // Middle parts of more than a few thousand lines count as changed as a whole.
  if (n * m > 0 && n * m <= 4_000_000) {
    const width = m + 1;
    const length = new Uint32Array((n + 1) * width);
    for (let i = n - 1; i >= 0; --i)
      for (let j = m - 1; j >= 0; --j)
        length[i * width + j] =
          a[head + i] === b[head + j]
            ? length[(i + 1) * width + j + 1]! + 1
            : Math.max(length[(i + 1) * width + j]!, length[i * width + j + 1]!);
    for (let i = 0, j = 0; i < n && j < m; ) {
      if (a[head + i] === b[head + j]) pairs.push([head + i++, head + j++]);
      else if (length[(i + 1) * width + j]! >= length[i * width + j + 1]!) ++i;
      else ++j;
    }
  }
  for (let i = tail; i > 0; --i) pairs.push([a.length - i, b.length - i]);
  return pairs;
}

function lines(text: string): string[] {
  return text.match(/[^\n]*\n|[^\n]+$/g) ?? [];
}

// Returns undefined for a conflict.
export function mergeTexts(base: string, ours: string, theirs: string): string | undefined {
  if (ours === theirs || theirs === base) return ours;
  if (ours === base) return theirs;
  const o = lines(base);
  const a = lines(ours);
  const b = lines(theirs);
  const ofOurs = new Map(commonLines(o, a));
  const ofTheirs = new Map(commonLines(o, b));
  let merged = "";
  let i = 0;
  let ia = 0;
  let ib = 0;
  while (i < o.length || ia < a.length || ib < b.length) {
    // The next line of the base that both keep ends the changed part.
    let next = i;
    while (next < o.length && !(ofOurs.has(next) && ofTheirs.has(next))) ++next;
    const endA = next < o.length ? ofOurs.get(next)! : a.length;
    const endB = next < o.length ? ofTheirs.get(next)! : b.length;
    const partO = o.slice(i, next).join("");
    const partA = a.slice(ia, endA).join("");
    const partB = b.slice(ib, endB).join("");
    if (partA === partB || partB === partO) merged += partA;
    else if (partA === partO) merged += partB;
    else return undefined;
    if (next >= o.length) break;
    merged += o[next]!;
    i = next + 1;
    ia = endA + 1;
    ib = endB + 1;
  }
  return merged;
}

export interface TextChange {
  from: number;
  to: number;
  insert: string;
}

// The one replacement that turns `before` into `after`; undefined if they are equal.
export function minimalChange(before: string, after: string): TextChange | undefined {
  if (before === after) return undefined;
  const limit = Math.min(before.length, after.length);
  let head = 0;
  while (head < limit && before[head] === after[head]) ++head;
  let tail = 0;
  while (tail < limit - head && before[before.length - 1 - tail] === after[after.length - 1 - tail]) ++tail;
  return { from: head, to: before.length - tail, insert: after.slice(head, after.length - tail) };
}
