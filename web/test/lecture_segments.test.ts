// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { joinSegments, segmentTitles, splitLecture } from "../src/lecture_segments";

declare const REPOSITORY: string;

const kinds = (text: string) => splitLecture(text).map((segment) => segment.kind);

test("every lesson is split into common text and stages, without a change of a byte", () => {
  const lessons = `${REPOSITORY}/programs/lessons`;
  let count = 0;
  for (const name of readdirSync(lessons))
    for (const file of readdirSync(`${lessons}/${name}`)) {
      if (!file.endsWith(".rt.glsl")) continue;
      const text = readFileSync(`${lessons}/${name}/${file}`, "utf8");
      const segments = splitLecture(text);
      assert.equal(joinSegments(segments), text, file);
      assert.equal(segments[0]!.kind, "common", file);
      assert.ok(segments.length >= 3 && segments.every((segment) => segment.kind !== "unknown"), file);
      assert.equal(segments.filter((segment) => segment.kind === "rgen").length, 1, file);
      const mains = text.match(/void main\(\)/g)!.length;
      assert.equal(segments.filter((segment) => segment.kind !== "common").length, mains, file);
      ++count;
    }
  assert.ok(count >= 20);
});

test("a marker is found at the start of the body, before main and in the body, in this order", () => {
  const miss = "/**** MISS SHADER ****/";
  const hit = "/*** closest hit shader ***/";
  assert.deepEqual(kinds(`void main() { ${miss}\n}\n`), ["rmiss"]);
  assert.deepEqual(kinds(`${hit}\nvoid main() {\n}\n`), ["rchit"]);
  assert.deepEqual(kinds(`void main() {\n  int a; ${miss}\n}\n`), ["rmiss"]);
  assert.deepEqual(kinds(`${hit}\nvoid main() { ${miss}\n}\n`), ["rmiss"]);
  assert.deepEqual(kinds(`${hit}\nvoid main() {\n int a; ${miss}\n}\n`), ["rchit"]);
});

test("text before a main belongs to it, comments do not count, and braces nest", () => {
  const text = [
    "uniform float a;",
    "void main() { /**** RAY GENERATION SHADER ****/",
    "  if (true) { /* } void main() { */ }",
    "}",
    "",
    "float helper() { return 1.0; }",
    "",
    "void main() { /**** MISS SHADER ****/",
    "}",
    "// end",
    "",
  ].join("\n");
  const segments = splitLecture(text);
  assert.deepEqual(segments.map((segment) => segment.kind), ["common", "rgen", "rmiss"]);
  assert.equal(segments[0]!.text, "uniform float a;\n");
  assert.ok(segments[2]!.text.startsWith("\nfloat helper()"));
  assert.ok(segments[2]!.text.endsWith("// end\n"));
  assert.equal(joinSegments(segments), text);
});

test("common text between stages has a part of its own", () => {
  const text = "void main() { /**** RAY GENERATION SHADER ****/\n}\n/**** COMMON START ****/\nint a;\n/**** COMMON END ****/\nvoid main() { /**** MISS SHADER ****/\n}\n";
  const segments = splitLecture(text);
  assert.deepEqual(segments.map((segment) => segment.kind), ["rgen", "common", "rmiss"]);
  assert.equal(segments[1]!.text, "/**** COMMON START ****/\nint a;\n/**** COMMON END ****/\n");
  assert.equal(joinSegments(segments), text);
});

test("a new program has the names of its stages, although declarations follow the comments", () => {
  const source = readFileSync(`${REPOSITORY}/src/program/new_program.cpp`, "utf8");
  const template = /kLecture = R"\(([\s\S]*?)\)"/.exec(source)![1]!;
  const segments = splitLecture(template);
  assert.equal(joinSegments(segments), template);
  assert.deepEqual(segmentTitles(segments), ["Common", "Ray generation", "Closest hit", "Miss"]);
  assert.match(segments[1]!.text, /^\/\*\*\*\* RAY GENERATION SHADER[\s\S]*uniform float fov;/);
});

test("a comment that has only the name of a stage counts, other words do not", () => {
  assert.deepEqual(kinds("// Miss shader\nuniform float a;\nvoid main() {\n}\n"), ["rmiss"]);
  assert.deepEqual(kinds("// This is not the miss shader.\nvoid main() {\n}\n"), ["unknown"]);
  const two = "/**** MISS SHADER ****/\nvoid main() {\n}\nint a;\nvoid main() {\n}\n";
  assert.deepEqual(kinds(two), ["rmiss", "unknown"], "the comment belongs to the first main");
});

test("incomplete text stays in one part", () => {
  assert.deepEqual(kinds(""), ["unknown"]);
  assert.deepEqual(kinds("int a;\n"), ["unknown"]);
  const open = "void main() { /**** MISS SHADER ****/\n  if (a) {\n";
  assert.deepEqual(kinds(open), ["rmiss"]);
  assert.equal(joinSegments(splitLecture(open)), open);
});

test("stages of the same kind have numbers", () => {
  assert.deepEqual(segmentTitles([{ kind: "common" }, { kind: "rcall" }, { kind: "rcall" }, { kind: "rmiss" }]), ["Common", "Callable 0", "Callable 1", "Miss"]);
});
