// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { columnOffset, countText, hasPage, rangeInLine } from "../src/diagnostic";

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
