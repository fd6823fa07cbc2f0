// SPDX-License-Identifier: Apache-2.0
// Small functions of the page: images, parameters, colors, camera, explanation, sharing.
import assert from "node:assert/strict";
import { test } from "node:test";
import { orbitPoint } from "../src/camera_control";
import { fromHex, toHex } from "../src/color";
import { compareImages } from "../src/image_difference";
import { resolveDocs } from "../src/lesson_panel";
import { sameValue, sliderRange } from "../src/parameters_panel";
import { validFolder } from "../src/program_chooser";
import { type Explanation, rayTree } from "../src/ray_tree";
import { sharedPage } from "../src/share";

test("images that differ", () => {
  const gray = new Uint8ClampedArray(4 * 100).fill(128);
  assert.equal(compareImages(gray, gray, 10).differing, 0);
  const rounding = gray.map((value, i) => (i % 4 === 0 ? value + 2 : value)) as Uint8ClampedArray;
  assert.equal(compareImages(gray, rounding, 10).differing, 0);
  const other = gray.slice();
  other[4 * 37] = 255;
  const difference = compareImages(other, gray, 10);
  assert.equal(difference.differing, 0.01);
  assert.deepEqual([difference.worst!.x, difference.worst!.y, difference.worst!.left[0], difference.worst!.right[0]], [7, 3, 255, 128]);
  assert.ok(difference.map[4 * 37]! > difference.map[4 * 37 + 1]!);
});

test("sliders have useful ranges", () => {
  const parameter = (fields: object) => ({ name: "a", type: "float" as const, default: 1, min: null, max: null, unit: "", help: "", ...fields });
  assert.deepEqual(sliderRange(parameter({ min: 0, max: 1 }), 0.5), { min: 0, max: 1, step: 0.001 });
  assert.equal(sliderRange(parameter({ default: 50 }), 50).max, 100);
  assert.ok(sliderRange(parameter({ default: -3 }), -3).min <= -3);
  assert.equal(sliderRange({ ...parameter({ min: 1, max: 16 }), type: "int" }, 4).step, 1);
  assert.ok(sliderRange(parameter({ min: 0, max: 1e30 }), 2).max < 100);
});

test("values are equal up to rounding", () => {
  assert.ok(sameValue([1, 0.1], [1, 0.1 + 1e-9]));
  assert.ok(!sameValue([1, 0.1], [1, 0.2]));
  assert.ok(!sameValue(true, false));
  assert.ok(!sameValue([1], [1, 1]));
});

test("colors of pickers", () => {
  assert.equal(toHex([1, 0, 0.2], false), "#ff0033");
  assert.equal(toHex([0.5, 0.5, 0.5], true), "#bcbcbc");
  assert.equal(toHex([4, 2, 0], false), "#ff8000");
  for (const linear of [false, true]) assert.equal(toHex(fromHex("#3a7bd5", linear), linear), "#3a7bd5");
});

test("a point on an orbit keeps its distance and does not reach the poles", () => {
  const turned = orbitPoint([0, 0, 2], 90, 0);
  assert.ok(Math.abs(turned[0] - 2) < 1e-3 && Math.abs(turned[2]) < 1e-3);
  const high = orbitPoint([0, 0, 2], 0, 500);
  assert.ok(high[1] > 1.9 && high[1] < 2 && Math.abs(Math.hypot(...high) - 2) < 1e-3);
  assert.deepEqual(orbitPoint([0, 0, 0], 10, 10), [0, 0, 0]);
});

test("links between pages of the documentation", () => {
  assert.equal(resolveDocs("lessons/05_shadow.md", "../images/lessons/05_shadow.png"), "images/lessons/05_shadow.png");
  assert.equal(resolveDocs("lessons/05_shadow.md", "04_diffuse.md#top"), "lessons/04_diffuse.md");
  assert.equal(resolveDocs("lessons/05_shadow.md", "../../programs/a"), undefined);
});

test("names of folders", () => {
  for (const name of ["mine", "a/b_c", "lessons/05_shadow", "v1.2"]) assert.ok(validFolder(name), name);
  for (const name of ["", "/a", "a/", "../a", "a//b", ".a", "a b", "a/../b", "-a"]) assert.ok(!validFolder(name), name);
});

test("the tree of an explanation numbers rays and shows what a payload becomes", () => {
  const explanation: Explanation = {
    pixel: [1, 2], size: [4, 4], outputs: [], contributions: [],
    events: [
      {
        type: "ray", stage: "a", file: "a.rt.glsl", line: 30, result: "hit", origin: [0, 1, 9],
        events: [
          { type: "payload", when: "before", variable: "payload", "payload.color": [0, 0, 0], "payload.level": 1 },
          { type: "payload", when: "after", variable: "payload", "payload.color": [1, 0.5, 0], "payload.level": 1 },
          { type: "closest-hit", stage: "a.rchit", instanceName: "sphere", t: 7.98123456, events: [{ type: "ray", file: "a.rt.glsl", line: 52, result: "miss", events: [{ type: "miss", stage: "a.rmiss" }] }] },
        ],
      },
      { type: "store", output: "image", mode: "store", value: [1, 0.5, 0, 1], line: 31 },
    ],
  };
  const [ray, store] = rayTree(explanation);
  assert.equal(ray!.title, "Ray 1: hit");
  assert.deepEqual(ray!.facts, [["origin", "0 1 9"], ["payload.color", "0 0 0 → 1 0.5 0"], ["payload.level", "1"]]);
  assert.equal(ray!.children[0]!.title, "Closest hit: sphere");
  assert.ok(ray!.children[0]!.facts.some(([name, value]) => name === "t" && value === "7.9812"));
  assert.equal(ray!.children[0]!.children[0]!.title, "Ray 2: miss");
  assert.equal(ray!.children[0]!.children[0]!.line, 52);
  assert.deepEqual(store!.color, [1, 0.5, 0]);
});

test("a shared page escapes text and refers to no other file", () => {
  const page = sharedPage({
    title: "<b>x", version: "1", scene: "", device: "", output: "image", samples: "4 samples", parameters: { tint: [1, 2] }, image: "data:image/png;base64,AA", width: 4, height: 4,
    files: [{ path: "a.rt.glsl", text: "// <script>alert(1)</script>\nvec3 a = vec3(1.0);\n" }],
  });
  assert.ok(!page.includes("<script") && !page.includes("<b>x") && page.includes("&#60;script"));
  assert.ok(!/(src|href)="(?!data:)/.test(page) && !page.includes("url("));
  assert.ok(page.includes("1, 2"));
  const code = /<pre><code>([\s\S]*)<\/code>/.exec(page)![1]!.replace(/<[^>]*>/g, "").replace(/&#(\d+);/g, (_, c) => String.fromCharCode(Number(c)));
  assert.equal(code, "// <script>alert(1)</script>\nvec3 a = vec3(1.0);\n");
});
