// SPDX-License-Identifier: Apache-2.0
import assert from "node:assert/strict";
import { test } from "node:test";
import { declarations, type GlslContext, helpFor, membersOf, visibleNames } from "../src/glsl_help";

const lecture = (stage: GlslContext["stage"], source = ""): GlslContext => ({ form: "lecture", stage, source, parameters: [] });
const folder = (stage: GlslContext["stage"], source = ""): GlslContext => ({ form: "folder", stage, source, parameters: [] });
const names = (context: GlslContext) => new Set(visibleNames(context).map((help) => help.name));

test("built-ins are those of the stage", () => {
  const closestHit = names(lecture("rchit"));
  const miss = names(lecture("rmiss"));
  const intersection = names(lecture("rint"));
  assert.ok(closestHit.has("gl_HitTEXT") && !miss.has("gl_HitTEXT"));
  assert.ok(intersection.has("reportIntersectionEXT") && !closestHit.has("reportIntersectionEXT"));
  assert.ok(names(lecture("rgen")).has("traceRayEXT") && !intersection.has("traceRayEXT"));
  assert.ok(names(lecture("rahit")).has("ignoreIntersectionEXT"));
  assert.ok(names(lecture(undefined)).has("gl_HitTEXT"), "common text belongs to all stages");
});

test("the lecture form has its names, and the library only if it is included", () => {
  const plain = names(lecture("rgen"));
  assert.ok(plain.has("gsnSetPixel") && plain.has("frameID") && plain.has("payload") && plain.has("userParam2"));
  assert.ok(!plain.has("cameraRay"));
  assert.ok(!names(lecture("rmiss")).has("gsnSetPixel"));
  assert.ok(names(lecture("rgen", "#include <quintet/camera.glsl>\n")).has("cameraRay"));
  const own = names(folder("rgen"));
  assert.ok(own.has("cameraRay") && !own.has("gsnSetPixel"));
});

test("help of the library has the signature of the header and the text of its documentation", () => {
  const help = helpFor("cameraRay", folder("rgen"))!;
  assert.equal(help.signature, "Ray cameraRay(vec2 pixel, vec2 lens)");
  assert.match(help.text, /unit direction/);
  assert.equal(help.include, "quintet/camera.glsl");
  assert.match(helpFor("kInfinity", folder("rgen"))!.signature, /^const float kInfinity/);
});

test("help says if a built-in does not exist in the stage", () => {
  assert.equal(helpFor("gl_HitTEXT", lecture("rmiss"))!.wrongStage, true);
  assert.equal(helpFor("gl_HitTEXT", lecture("rchit"))!.wrongStage, false);
  assert.equal(helpFor("notAName", lecture("rchit")), undefined);
});

test("parameters come first and have their limits", () => {
  const context: GlslContext = { ...lecture("rgen"), parameters: [{ name: "size", type: "float", default: 1, min: 0, max: 2, unit: "m", help: "Size" }] };
  assert.equal(visibleNames(context)[0]!.name, "size");
  assert.match(helpFor("size", context)!.origin, /default 1, 0 to 2, m/);
});

test("declarations of the program", () => {
  const found = new Map(
    declarations("struct A { vec3 p; float q; };\nconst int count = 3;\nfloat f(vec3 a, float b) { return a.x; }\n// float hidden;\nvoid main() { A a; vec3 n0, n1; }").map((declaration) => [declaration.name, declaration]),
  );
  assert.equal(found.get("A")!.kind, "struct");
  assert.equal(found.get("count")!.kind, "constant");
  assert.equal(found.get("f")!.signature, "float f(vec3 a, float b)");
  assert.equal(found.get("a")!.type, "vec3");
  assert.equal(found.get("n1")!.signature, "vec3 n1");
  assert.ok(!found.has("hidden") && !found.has("main"));
});

test("members of structs, vectors, the payload and library structs", () => {
  const source = "struct RayPayloadType { vec3 color; bool seen; };\nvec2 uv;";
  assert.deepEqual(membersOf("payload", lecture("rgen", source)).map((member) => member.name), ["color", "seen"]);
  assert.ok(membersOf("uv", lecture("rgen", source)).some((member) => member.name === "y"));
  assert.ok(!membersOf("uv", lecture("rgen", source)).some((member) => member.name === "z"));
  assert.ok(membersOf("ray", folder("rgen", "Ray ray;")).some((member) => member.name === "direction"));
  assert.deepEqual(membersOf("unknown", lecture("rgen", source)), []);
});
