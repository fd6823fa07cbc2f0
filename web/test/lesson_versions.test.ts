// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { LessonVersions, sameFiles, type Version } from "../src/lesson_versions";

test("each version is kept once, the newest one first, and old ones are dropped", () => {
  const store = { value: [] as Version[] };
  const versions = new LessonVersions("05_shadow", store);
  versions.keep("before the reset", { a: "1" }, 10);
  versions.keep("before the solution", { a: "2" }, 20);
  versions.keep("again", { a: "1" }, 30);
  assert.deepEqual(versions.list.map(({ label, time }) => [label, time]), [["before the solution", 20], ["before the reset", 10]]);
  assert.equal(versions.find({ a: "1" })!.label, "before the reset");
  assert.equal(versions.find({ a: "1", b: "" }), undefined);
  for (let i = 0; i < 30; ++i) versions.keep("many", { a: `n${i}` }, 100 + i);
  assert.equal(versions.list.length, 20);
  assert.equal(versions.list[0]!.files["a"], "n29");
  assert.deepEqual(new LessonVersions("05_shadow", store).list, versions.list, "they stay in the store");
});

test("files are equal if names and texts are", () => {
  assert.ok(sameFiles({ a: "1", b: "2" }, { b: "2", a: "1" }));
  assert.ok(!sameFiles({ a: "1" }, { a: "1", b: "" }));
  assert.ok(!sameFiles({ a: "1" }, { b: "1" }));
});
