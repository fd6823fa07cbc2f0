// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { columnOffset, countText, type Diagnostic, hasPage, isRunFinding, pixelOf, rangeInLine } from "../src/diagnostic";

test("columns count bytes of UTF-8", () => {
  assert.equal(columnOffset("abc", 1), 0);
  assert.equal(columnOffset("abc", 3), 2);
  assert.equal(columnOffset("äb", 3), 1);
  assert.equal(columnOffset("😀b", 5), 2);
  assert.equal(columnOffset("abc", 99), 3);
});

test("the underlined range is a word, a quoted name or the code of the line", () => {
  assert.deepEqual(rangeInLine("  payload.color = red;", 3, ""), { from: 2, to: 15 });
  assert.deepEqual(rangeInLine("  float x = colr * 2.0;", 0, "'colr' : undeclared identifier"), { from: 12, to: 16 });
  assert.deepEqual(rangeInLine("  return 1;  // colr", 0, "'colr' is unknown"), { from: 2, to: 11 });
  assert.deepEqual(rangeInLine("", 0, "text"), { from: 0, to: 0 });
  assert.deepEqual(rangeInLine("ab", 9, ""), { from: 0, to: 2 });
});

test("counts by severity", () => {
  const of = (severity: "error" | "warning" | "note") => ({ severity, file: "", line: 0, column: 0, id: "", text: "" });
  assert.equal(countText([]), "");
  assert.equal(countText([of("error"), of("note"), of("error")]), "2 errors, 1 note");
});

test("ids of the check have pages", () => {
  assert.ok(hasPage("Q101"));
  assert.ok(!hasPage("GLSL"));
});

test("what only an image shows has a pixel, and no location in a source", () => {
  const diagnostic = (fields: Partial<Diagnostic>): Diagnostic => ({ severity: "warning", file: "", line: 0, column: 0, id: "Q002", text: "", ...fields });
  const found = diagnostic({ text: "3 pixels of the output 'image' were not finite in at least one frame; the first is at pixel (34, 120), counted from the top left corner" });
  assert.ok(isRunFinding(found));
  assert.deepEqual(pixelOf(found), { x: 34, y: 120 });
  assert.equal(pixelOf(diagnostic({ id: "Q003", text: "1 trace was deeper" })), undefined);
  assert.equal(isRunFinding(diagnostic({ file: "a.rt.glsl", text: "at pixel (1, 2)" })), false);
  assert.equal(pixelOf(diagnostic({ file: "a.rt.glsl", text: "at pixel (1, 2)" })), undefined);
  assert.equal(isRunFinding(diagnostic({ severity: "error" })), false);
});
