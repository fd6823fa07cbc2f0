// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { layoutGraph } from "../src/layered_layout";
import { hitObjectLegend, pipelineGraph } from "../src/pipeline_graph";
import type { PipelineModel } from "../src/pipeline_model";

const location = (line: number) => ({ file: "a.rt.glsl", line, column: 3 });
const trace = (stage: number, line: number, targets: PipelineModel["traces"][number]["targets"]) => ({
  stage, location: location(line), rays: [0], flags: "None", mask: "0xff", offset: "0", stride: "0", miss: "0",
  payload: { name: "payload", type: "RayPayloadType", bytes: 16 }, inLoop: false, searches: false, executes: false, skipsClosestHit: false, skipsAnyHit: false, targets, diagnostics: [],
});

// The lesson on shadows: the closest-hit shader traces again.
function shadowModel(): PipelineModel {
  return {
    program: "shadow", scene: "shadow.scene.toml", recursion: { depth: 2, declared: null, stackBytes: 64 }, rays: ["ray"],
    stages: [
      { kind: "ray generation", file: "a.rt.glsl", reached: true, diagnostics: [] },
      { kind: "closest-hit", file: "a.rt.glsl", reached: true, diagnostics: [] },
      { kind: "miss", file: "a.rt.glsl", reached: true, diagnostics: [] },
    ],
    hits: [
      { group: "triangles", ray: "ray", closestHit: 1, anyHit: null, intersection: null, record: "", binding: [], geometry: ["floor"], diagnostics: [] },
      { group: "boxes", ray: "ray", closestHit: 1, anyHit: null, intersection: null, record: "", binding: [], geometry: [], diagnostics: [] },
    ],
    misses: [{ name: "", stage: 2, record: "" }],
    callables: [],
    traces: [
      trace(0, 30, [{ list: "hits", index: 0, exact: true, diagnostics: [] }, { list: "hits", index: 1, exact: true, diagnostics: [] }, { list: "misses", index: 0, exact: true, diagnostics: [] }]),
      trace(1, 52, [{ list: "hits", index: 0, exact: false, diagnostics: [0] }, { list: "misses", index: 0, exact: true, diagnostics: [] }]),
    ],
    calls: [],
    diagnostics: [{ severity: "error", file: "a.rt.glsl", line: 52, column: 3, id: "Q401", text: "recursion" }],
  };
}

test("groups with the same shaders share a box, and arrows connect what runs", () => {
  const { nodes, edges } = pipelineGraph(shadowModel());
  assert.deepEqual(nodes.map((node) => node.kind), ["rgen", "trace", "trace", "hit", "miss"]);
  const [rgen, first, second, hit, miss] = [0, 1, 2, 3, 4];
  const has = (from: number, to: number) => edges.some((edge) => edge.from === from && edge.to === to);
  assert.ok(has(rgen, first) && has(first, hit) && has(first, miss) && has(hit, second) && has(second, hit) && has(second, miss));
  assert.equal(edges.length, 6);
  const recursion = edges.find((edge) => edge.from === second && edge.to === hit)!;
  assert.equal(recursion.exact, false);
  assert.deepEqual(recursion.diagnostics, [0]);
  assert.deepEqual(nodes[second]!.location, location(52));
  assert.equal(nodes[hit]!.stage!.kind, "closest-hit");
  assert.deepEqual(nodes[hit]!.rows.filter(([label]) => label === "group").map(([, text]) => text), ["triangles", "boxes"]);
});

test("searches and executions of hit objects are named as such", () => {
  const model = shadowModel();
  assert.equal(hitObjectLegend(model), "");
  model.traces[0] = { ...model.traces[0]!, searches: true, inLoop: true };
  model.traces[1] = { ...model.traces[1]!, executes: true };
  const { nodes } = pipelineGraph(model);
  const traces = nodes.filter((node) => node.kind === "trace");
  assert.deepEqual(traces.map((node) => node.title), ["Hit object search, line 30", "Hit object execution, line 52"]);
  const notes = traces.map((node) => node.rows.filter(([label]) => label === "").map(([, text]) => text));
  assert.deepEqual(notes, [["in a loop", "runs no closest-hit and no miss shader"], ["runs no intersection and no any-hit shader"]]);
  assert.equal(hitObjectLegend(model), "Search: fills a hit object · Execution: runs its shader");
  model.traces[1] = shadowModel().traces[1]!;
  assert.equal(hitObjectLegend(model), "Search: fills a hit object");
});

test("the layout has no overlaps, and edges lead to the right except for cycles", () => {
  const { nodes, edges } = pipelineGraph(shadowModel());
  const sizes = nodes.map((node) => ({ width: 120, height: 30 + 16 * node.rows.length }));
  const layout = layoutGraph(sizes, edges);
  for (let i = 0; i < nodes.length; ++i)
    for (let k = 0; k < i; ++k) {
      const [a, b] = [layout.nodes[i]!, layout.nodes[k]!];
      const apart = a.x + sizes[i]!.width <= b.x || b.x + sizes[k]!.width <= a.x || a.y + sizes[i]!.height <= b.y || b.y + sizes[k]!.height <= a.y;
      assert.ok(apart, `${i} and ${k} overlap`);
    }
  const back = edges.filter((_, i) => layout.edges[i]![0]!.x > layout.edges[i]![layout.edges[i]!.length - 1]!.x);
  assert.equal(back.length, 1);
  for (const point of [...layout.nodes, ...layout.edges.flat()]) assert.ok(point.y >= 0 && point.y <= layout.height);
  assert.ok(layout.nodes.every((at, i) => at.x >= 0 && at.x + sizes[i]!.width <= layout.width));
});

test("an empty pipeline and a shader that traces itself", () => {
  assert.deepEqual(layoutGraph([], []).nodes, []);
  const chain = layoutGraph([{ width: 10, height: 10 }, { width: 10, height: 10 }, { width: 10, height: 10 }], [{ from: 0, to: 1 }, { from: 1, to: 2 }, { from: 0, to: 2 }]);
  assert.ok(chain.nodes[0]!.x < chain.nodes[1]!.x && chain.nodes[1]!.x < chain.nodes[2]!.x);
  assert.equal(chain.edges[2]!.length, 3, "an edge over a column bends in it");
});
