// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { mergeTexts, minimalChange } from "../src/text_merge";

test("changes of different lines are merged", () => {
  assert.equal(mergeTexts("a\nb\nc\nd\n", "a\nB\nc\nd\n", "a\nb\nc\nD\n"), "a\nB\nc\nD\n");
  assert.equal(mergeTexts("a\nb\nc\n", "x\na\nb\nc\n", "a\nb\nc\ny\n"), "x\na\nb\nc\ny\n");
  assert.equal(mergeTexts("a\nb\nc\nd\ne\n", "a\nc\nd\ne\n", "a\nb\nc\nd\nD\ne\n"), "a\nc\nd\nD\ne\n");
});

test("changes of the same lines are a conflict", () => {
  assert.equal(mergeTexts("a\nb\nc\n", "a\nx\nc\n", "a\ny\nc\n"), undefined);
  assert.equal(mergeTexts("", "x\n", "y\n"), undefined);
});

test("one side or equal sides win", () => {
  assert.equal(mergeTexts("a\n", "a\n", "b\n"), "b\n");
  assert.equal(mergeTexts("a\n", "b\n", "a\n"), "b\n");
  assert.equal(mergeTexts("a\n", "b\n", "b\n"), "b\n");
  assert.equal(mergeTexts("a\nb\n", "a\nc\nb\n", "a\nc\nb\n"), "a\nc\nb\n");
});

test("merging with random edits of separate lines gives both edits", () => {
  let seed = 7;
  const random = (count: number) => ((seed = (seed * 1103515245 + 12345) % 2147483648) >> 8) % count;
  for (let round = 0; round < 200; ++round) {
    const base = Array.from({ length: 30 }, () => `line ${random(6)}`);
    const first = 3 + random(8);
    const second = 18 + random(8);
    const ours = base.map((line, i) => (i === first ? "ours" : line));
    const theirs = base.map((line, i) => (i === second ? "theirs" : line));
    const both = base.map((line, i) => (i === first ? "ours" : i === second ? "theirs" : line));
    const join = (lines: string[]) => `${lines.join("\n")}\n`;
    assert.equal(mergeTexts(join(base), join(ours), join(theirs)), join(both));
  }
});

test("the minimal change turns one text into the other", () => {
  assert.equal(minimalChange("abc", "abc"), undefined);
  assert.deepEqual(minimalChange("abcd", "abXd"), { from: 2, to: 3, insert: "X" });
  assert.deepEqual(minimalChange("aa", "aaa"), { from: 2, to: 2, insert: "a" });
  for (const [before, after] of [["", "x"], ["x", ""], ["abab", "ab"], ["one two", "one more two"]] as const) {
    const change = minimalChange(before, after)!;
    assert.equal(before.slice(0, change.from) + change.insert + before.slice(change.to), after);
  }
});
