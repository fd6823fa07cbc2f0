// SPDX-License-Identifier: Apache-2.0
// The linked pipeline as boxes and arrows: shaders, the traces and calls in them, and what these reach. Hit groups with the
// same shaders share a box.
import type { Location, PipelineModel, Target } from "./pipeline_model";

export interface GraphNode {
  kind: "rgen" | "trace" | "call" | "hit" | "miss" | "callable";
  title: string;
  rows: [string, string][];
  diagnostics: number[]; // indices in PipelineModel.diagnostics
  // Where the node is in the sources: of a stage, or of a line.
  stage?: { kind: string; file: string };
  location?: Location;
}

export interface PipelineEdge {
  from: number;
  to: number;
  exact: boolean;
  ray?: number; // the only ray type of the trace
  diagnostics: number[];
}

export interface PipelineGraph {
  nodes: GraphNode[];
  edges: PipelineEdge[];
}

const baseName = (file: string) => file.replace(/^.*\//, "");

type Trace = PipelineModel["traces"][number];

// Traces of hit objects (shader execution reordering) have two parts, at two lines or in one instruction.
const traceName = (trace: Trace) => (trace.searches ? "Hit object search" : trace.executes ? "Hit object execution" : "traceRayEXT");

function traceNotes(trace: Trace): string[] {
  return [
    ...(trace.inLoop ? ["in a loop"] : []),
    ...(trace.searches ? ["runs no closest-hit and no miss shader"] : []),
    ...(trace.executes ? ["runs no intersection and no any-hit shader"] : []),
  ];
}

// What the names of such boxes mean; empty if there are none.
export function hitObjectLegend(model: PipelineModel): string {
  return [
    ...(model.traces.some((trace) => trace.searches) ? ["Search: fills a hit object"] : []),
    ...(model.traces.some((trace) => trace.executes) ? ["Execution: runs its shader"] : []),
  ].join(" · ");
}

export function pipelineGraph(model: PipelineModel): PipelineGraph {
  const nodes: GraphNode[] = [];
  const edges: PipelineEdge[] = [];
  const runs: number[][] = model.stages.map(() => []); // nodes that run a stage
  const stageOf = (index: number) => ({ kind: model.stages[index]!.kind, file: model.stages[index]!.file });
  const add = (node: GraphNode, stages: (number | null)[]) => {
    nodes.push(node);
    for (const stage of stages) {
      if (stage === null) continue;
      runs[stage]!.push(nodes.length - 1);
      node.diagnostics.push(...model.stages[stage]!.diagnostics);
    }
    return nodes.length - 1;
  };
  model.stages.forEach((stage, i) => {
    if (stage.kind.startsWith("ray")) add({ kind: "rgen", title: "Ray generation", rows: [["", baseName(stage.file)]], diagnostics: [], stage: stageOf(i) }, [i]);
  });
  const traceNodes = model.traces.map((trace) =>
    add(
      {
        kind: "trace",
        title: `${traceName(trace)}, line ${trace.location.line}`,
        rows: [
          ...(trace.rays.length > 0 ? [["ray", trace.rays.map((ray) => model.rays[ray]).join(", ")] as [string, string]] : []),
          ["flags", trace.flags],
          ["mask", trace.mask],
          ["record", `offset ${trace.offset}, stride ${trace.stride}`],
          ["miss", trace.miss],
          ["payload", `${trace.payload.type} ${trace.payload.name} (${trace.payload.bytes} B)`],
          ...traceNotes(trace).map((note) => ["", note] as [string, string]),
        ],
        diagnostics: [...trace.diagnostics],
        location: trace.location,
      },
      [],
    ),
  );
  const callNodes = model.calls.map((call) =>
    add(
      {
        kind: "call",
        title: `executeCallableEXT, line ${call.location.line}`,
        rows: [
          ["index", call.index],
          ["data", `${call.data.type} ${call.data.name} (${call.data.bytes} B)`],
        ],
        diagnostics: [...call.diagnostics],
        location: call.location,
      },
      [],
    ),
  );
  const targeted = new Set([...model.traces, ...model.calls].flatMap((call) => call.targets.map((target) => `${target.list}${target.index}`)));
  const targets = new Map<string, number>();
  const shared = new Map<string, number>();
  model.hits.forEach((hit, i) => {
    const stages = [hit.intersection, hit.anyHit, hit.closestHit];
    if (!targeted.has(`hits${i}`) && stages.every((stage) => stage === null)) return;
    const key = JSON.stringify([stages, hit.ray]);
    let node = shared.get(key);
    if (node === undefined) {
      const rows: [string, string][] = [];
      const names: [string, number | null][] = [["intersection", hit.intersection], ["any hit", hit.anyHit], ["closest hit", hit.closestHit]];
      for (const [name, stage] of names) if (stage !== null) rows.push([name, baseName(model.stages[stage]!.file)]);
      if (rows.length === 0) rows.push(["", "no shader runs"]);
      const main = hit.closestHit ?? hit.anyHit ?? hit.intersection;
      const title = model.rays.length > 1 ? `Hit, ray ${hit.ray}` : "Hit";
      node = add({ kind: "hit", title, rows, diagnostics: [], ...(main !== null && { stage: stageOf(main) }) }, stages);
      shared.set(key, node);
    }
    const box = nodes[node]!;
    const geometry = hit.geometry.length > 3 ? `${hit.geometry.slice(0, 3).join(", ")}, …` : hit.geometry.join(", ");
    box.rows.push(["group", hit.group + (hit.record ? ` {${hit.record}}` : "")]);
    if (geometry) box.rows.push(["", geometry]);
    box.diagnostics.push(...hit.diagnostics);
    targets.set(`hits${i}`, node);
  });
  const records = (list: "misses" | "callables", kind: "miss" | "callable", name: string) =>
    model[list].forEach((record, i) => {
      const rows: [string, string][] = [];
      if (record.name) rows.push(["name", record.name]);
      rows.push(["", record.stage === null ? "no shader runs" : baseName(model.stages[record.stage]!.file)]);
      if (record.record) rows.push(["record", record.record]);
      const node = add({ kind, title: `${name} ${i}`, rows, diagnostics: [], ...(record.stage !== null && { stage: stageOf(record.stage) }) }, [record.stage]);
      targets.set(`${list}${i}`, node);
    });
  records("misses", "miss", "Miss");
  records("callables", "callable", "Callable");

  const connect = (call: { stage: number; targets: Target[] }, node: number, ray?: number) => {
    for (const from of new Set(runs[call.stage])) edges.push({ from, to: node, exact: true, diagnostics: [] });
    const reached = new Map<number, PipelineEdge>();
    for (const target of call.targets) {
      const to = targets.get(`${target.list}${target.index}`);
      if (to === undefined) continue;
      const known = reached.get(to);
      if (known) {
        known.exact &&= target.exact;
        known.diagnostics.push(...target.diagnostics);
      } else reached.set(to, { from: node, to, exact: target.exact, diagnostics: [...target.diagnostics], ...(ray !== undefined && { ray }) });
    }
    edges.push(...reached.values());
  };
  model.traces.forEach((trace, i) => connect(trace, traceNodes[i]!, trace.rays.length === 1 ? trace.rays[0] : undefined));
  model.calls.forEach((call, i) => connect(call, callNodes[i]!));
  for (const node of nodes) node.diagnostics = [...new Set(node.diagnostics)];
  return { nodes, edges };
}
