// SPDX-License-Identifier: Apache-2.0
// Small programs in memory, and helpers to edit and check them.
#ifndef QUINTET_TESTS_UNIT_CHECK_CHECK_TEST_SUPPORT_H
#define QUINTET_TESTS_UNIT_CHECK_CHECK_TEST_SUPPORT_H

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "base/file.h"
#include "check/check.h"
#include "program/description/parser.h"
#include "program/hit_group_binding.h"
#include "program/program_test_support.h"

namespace quintet::check {

using namespace program;

inline constexpr const char* kHead = R"(#version 460
#extension GL_EXT_ray_tracing : require
const uint kRay_primary = 0u, kRay_shadow = 1u, kRayTypeCount = 2u, kMiss_primary = 0u, kMiss_shadow = 1u;
struct Payload { vec3 color; float t; };
struct Shadow { uint lit; };
)";

// A program without mistakes. Ray generation traces `primary` rays, and the closest-hit shader of the only hit group
// traces `shadow` rays.
inline Files cleanFiles() {
  const std::string head = kHead;
  return {{"program.toml", R"([program]
ray_generation = "main.rgen"

[[ray]]
name = "primary"
miss = "sky.rmiss"

[[ray]]
name = "shadow"
miss = "lit.rmiss"

[[hit_group]]
name = "surface"
primary = { closest_hit = "surface.rchit", any_hit = "cut.rahit" }
shadow = { any_hit = "cut_shadow.rahit" }
)"},
          {"main.rgen", changed(head, "require\n", "require\n#include <quintet/output.glsl>\n") +
                            R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadEXT Payload payload;
void main() {
  traceRayEXT(tlas, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary, vec3(0), 0.0, vec3(0, 0, 1), 1e30, 0);
  vec3 color = payload.color;
  if (payload.t > 0.0) color *= payload.t;
  addOutput(0u, launchPixel(), vec4(color, 1.0));
}
)"},
          {"sky.rmiss", head + R"(layout(location = 0) rayPayloadInEXT Payload payload;
void main() {
  payload.color = gl_WorldRayDirectionEXT;
  payload.t = -1.0;
}
)"},
          {"lit.rmiss", head + R"(layout(location = 1) rayPayloadInEXT Shadow payload;
void main() { payload.lit = 1u; }
)"},
          {"surface.rchit", head + R"(layout(set = 0, binding = 0) uniform accelerationStructureEXT tlas;
layout(location = 0) rayPayloadInEXT Payload payload;
layout(location = 1) rayPayloadEXT Shadow shadow;
hitAttributeEXT vec2 attribs;
void main() {
  const vec3 origin = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  shadow.lit = 0u;
  traceRayEXT(tlas, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow, kRayTypeCount, kMiss_shadow,
              origin, 1e-3, vec3(0, 1, 0), 1e30, 1);
  payload.color = shadow.lit != 0u ? vec3(attribs, 1.0) : vec3(0.0);
  payload.t = gl_HitTEXT;
}
)"},
          {"cut.rahit", head + R"(layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 attribs;
void main() { if (attribs.x < 0.5) ignoreIntersectionEXT; }
)"},
          {"cut_shadow.rahit", head + R"(layout(location = 1) rayPayloadInEXT Shadow payload;
hitAttributeEXT vec2 attribs;
void main() { if (attribs.x < 0.5) ignoreIntersectionEXT; }
)"}};
}

// With a procedural hit group whose intersection shader writes `struct Hit { vec3 normal; }`.
inline Files boxFiles() {
  const std::string head = kHead + std::string("struct Hit { vec3 normal; };\n");
  Files files = cleanFiles();
  files["program.toml"] += R"(
[[hit_group]]
name = "boxes"
geometry = "procedural"
primary = { closest_hit = "box.rchit", intersection = "box.rint" }
shadow = { intersection = "box.rint" }
)";
  files["box.rint"] = head + R"(hitAttributeEXT Hit hit;
void main() {
  hit.normal = gl_ObjectRayOriginEXT;
  reportIntersectionEXT(1.0, 0u);
}
)";
  files["box.rchit"] = head + R"(layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT Hit hit;
void main() {
  payload.color = hit.normal;
  payload.t = gl_HitTEXT;
}
)";
  return files;
}

// With a callable shader that ray generation calls with a constant index.
inline Files callFiles() {
  Files files = cleanFiles();
  files["program.toml"] = changed(files["program.toml"], "\n\n[[ray]]", "\ncallables = [\"tint.rcall\"]\n\n[[ray]]");
  files["main.rgen"] = changed(files["main.rgen"], "void main() {",
                               "layout(location = 0) callableDataEXT vec4 data;\nvoid main() {\n  data = vec4(0.5);\n  "
                               "executeCallableEXT(0u, 0);");
  files["main.rgen"] = changed(files["main.rgen"], "vec4(color, 1.0)", "vec4(color, 1.0) * data");
  files["tint.rcall"] =
      kHead + std::string("layout(location = 0) callableDataInEXT vec4 data;\nvoid main() { data *= 2.0; }\n");
  return files;
}

inline const shader::Compiler& checkCompiler() {
  static const shader::Compiler compiler([] {
    shader::CompilerOptions options;
    options.cacheFolder = cacheFolder() / "shaders";
    return options;
  }());
  return compiler;
}

inline CheckResult checkFiles(const Files& files, const program::SceneFacts* scene = nullptr,
                              const DeviceLimits& limits = {}) {
  return check(program::parseProgram(files.at("program.toml"), "demo", "folder/demo", files), checkCompiler(), scene,
               limits);
}

// Returns a line "Q104 main.rgen:11:3 text" per diagnostic, with paths relative to the program.
inline std::string textOf(const CheckResult& result) {
  std::string text;
  for (const Diagnostic& d : result.diagnostics) {
    std::string file = d.file.starts_with("folder/demo/") ? d.file.substr(12) : d.file;
    text += d.id + " " + file + ":" + std::to_string(d.line) + ":" + std::to_string(d.column) + " " + d.text + "\n";
  }
  return text;
}

// True if a line of the text starts with "ID file:line:column" and contains all words.
inline testing::AssertionResult reports(const std::string& text, const std::string& start,
                                        const std::vector<std::string>& words = {}) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto contains = [&](const std::string& word) { return line.find(word) != std::string::npos; };
    if (line.starts_with(start) && std::ranges::all_of(words, contains)) return testing::AssertionSuccess();
  }
  return testing::AssertionFailure() << "expected " << start << " with the words, got:\n" << text;
}

// As reports(), and it is the only diagnostic.
inline testing::AssertionResult reportsOnly(const std::string& text, const std::string& start,
                                            const std::vector<std::string>& words = {}) {
  if (std::ranges::count(text, '\n') != 1)
    return testing::AssertionFailure() << "expected one diagnostic, got:\n" << text;
  return reports(text, start, words);
}

// Returns the files with `from` replaced by `to` in one of them.
inline Files edited(Files files, const std::string& file, const std::string& from, const std::string& to) {
  files[file] = changed(files[file], from, to);
  return files;
}

inline std::string checkEdited(const Files& files, const std::string& file, const std::string& from,
                               const std::string& to, const program::SceneFacts* scene = nullptr,
                               const DeviceLimits& limits = {}) {
  return textOf(checkFiles(edited(files, file, from, to), scene, limits));
}

// Returns a scene with one instance of one mesh with these geometries.
inline program::SceneFacts sceneWith(std::vector<program::GeometryFacts> geometries) {
  program::SceneFacts scene{"scene.glb", std::move(geometries), {}};
  scene.instances.push_back({"thing", 0, static_cast<std::uint32_t>(scene.geometries.size()), 0xFF, false, false});
  return scene;
}

}  // namespace quintet::check
#endif
