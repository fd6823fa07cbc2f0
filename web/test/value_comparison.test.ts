// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Explanation } from "../src/ray_tree";
import { compareMeans, comparePayloads, comparePrints, linesMatch, payloadAfter, valuesMatch } from "../src/value_comparison";

test("values match within the tolerance", () => {
  assert.ok(valuesMatch(1, 1.00005));
  assert.ok(!valuesMatch(1, 1.001));
  assert.ok(valuesMatch(1, 1.01, 0.02));
  assert.ok(!valuesMatch(0, 0.001));
  assert.ok(valuesMatch([1, [2, 3]], [1, [2, 3]]));
  assert.ok(!valuesMatch([1, 2], [1, 2, 3]));
  assert.ok(!valuesMatch("nan", 0));
  assert.ok(valuesMatch("nan", "nan"));
});

test("lines match apart from spaces and rounding", () => {
  assert.ok(linesMatch("t = 1.50000, n -2", "t =  1.50001, n -2"));
  assert.ok(!linesMatch("t = 1.5", "u = 1.5"));
  assert.ok(!linesMatch("t = 1.5", "t = 1.6"));
  assert.ok(!linesMatch("1 2", "1"));
});

const kBlocks = [{ x: 0, y: 0, width: 2, height: 1 }, { x: 4, y: 2, width: 10, height: 10 }];

test("means are compared block by block, without alpha", () => {
  const equal = compareMeans(kBlocks, 0.02, [[1, 1, 1, 1], [0.5, 0.5, 0.505, 0]], [[1, 1, 1, 1], [0.5, 0.5, 0.5, 1]]);
  assert.ok(equal.passed, equal.message);
  const different = compareMeans(kBlocks, 0.02, [[1, 1, 1, 1], [0.5, 0.5, 0.6, 1]], [[1, 1, 1, 1], [0.5, 0.5, 0.5, 1]]);
  assert.ok(!different.passed);
  assert.match(different.message, /pixels 4, 2 to 13, 11 is 0\.5 0\.5 0\.6 \(linear\), that of the solution is 0\.5 0\.5 0\.5/);
});

const explanation = (color: number[]): Explanation => ({
  pixel: [1, 2],
  size: [8, 8],
  outputs: [],
  contributions: [],
  events: [{ type: "ray", events: [{ type: "payload", when: "before", variable: "payload", "payload.color": [9, 9, 9] }, { type: "miss" }, { type: "payload", when: "after", variable: "payload", "payload.color": color }] }],
});

test("a payload is read after the first ray", () => {
  assert.deepEqual(payloadAfter(explanation([1, 2, 3]), "color"), [1, 2, 3]);
  assert.equal(payloadAfter(explanation([1, 2, 3]), "depth"), undefined);
  assert.ok(comparePayloads([1, 2], "color", explanation([1, 2, 3]), explanation([1, 2, 3])).passed);
  const different = comparePayloads([1, 2], "color", explanation([0, 0, 0]), explanation([0.25, 0.5, 0.75]));
  assert.ok(!different.passed);
  assert.equal(different.message, "After the first ray of pixel 1, 2, payload.color is 0 0 0; the solution has 0.25 0.5 0.75.");
  const none = comparePayloads([1, 2], "color", { ...explanation([]), events: [] }, explanation([1, 2, 3]));
  assert.ok(!none.passed);
  assert.match(none.message, /has no ray/);
});

test("printed lines are compared in their order", () => {
  assert.ok(comparePrints([1, 2], ["a 1", "b 2"], ["a 1", "b 2"]).passed);
  assert.match(comparePrints([1, 2], [], ["a"]).message, /prints nothing for pixel 1, 2; the solution prints: a/);
  assert.match(comparePrints([1, 2], ["a 1"], ["a 2"]).message, /prints: a 1 · The solution prints: a 2/);
  assert.match(comparePrints([1, 2], ["a", "b"], ["a"]).message, /prints 2 lines .* prints 1 line\./);
});
