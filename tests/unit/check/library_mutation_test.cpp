// SPDX-License-Identifier: Apache-2.0
// Mutations of the traces and stages of the shader library: mistakes of users who write such files themselves.
// mutation_test.cpp mutates the files of programs.
#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"
#include "check_test_support.h"
#include "program/load.h"
#include "shader/library.h"
#include "temp_folder.h"

namespace quintet::check {
namespace {

struct Mistake {
  const char* ids;   // any of them must be reported
  const char* file;  // of the library
  const char* from;
  const char* to;
};

constexpr const char* kRadianceTrace = "gl_RayFlagsNoneEXT, 0xFFu, kRay_radiance, kRayTypeCount, kMiss_radiance";
constexpr const char* kSurfaceHit = "payload = triangleHit(baryCoord, raySeed(payload));";

const Mistake kLibraryMistakes[] = {
    // Payloads.
    {"Q101", "quintet/stages/radiance.rmiss", "rayPayloadInEXT HitPayload payload;",
     "rayPayloadInEXT Wide { uint more; HitPayload inner; } wide;\n#define payload wide.inner"},
    {"Q101", "quintet/stages/shadow.rmiss", "rayPayloadInEXT ShadowPayload payload;",
     "rayPayloadInEXT Wide { ShadowPayload inner; vec3 color; } wide;\n#define payload wide.inner"},
    {"Q101", "quintet/stages/surface.rchit", "rayPayloadInEXT HitPayload payload;",
     "rayPayloadInEXT Wide { vec3 color; HitPayload inner; } wide;\n#define payload wide.inner"},
    {"Q101", "quintet/stages/alpha_shadow.rahit", "rayPayloadInEXT ShadowPayload payload;",
     "rayPayloadInEXT HitPayload payload;"},
    {"Q101", "quintet/stages/alpha.rahit", "rayPayloadInEXT HitPayload payload;",
     "rayPayloadInEXT ShadowPayload payload;"},
    {"Q102", "quintet/stages/shadow.rmiss", "location = 1", "location = 2"},
    {"Q102", "quintet/stages/radiance.rmiss", "location = 0", "location = 3"},
    {"Q102", "quintet/stages/surface.rchit", "location = 0", "location = 1"},
    {"Q103", "quintet/stages/radiance.rmiss", "rayPayloadInEXT", "rayPayloadEXT"},
    {"Q103", "quintet/stages/shadow.rmiss", "rayPayloadInEXT", "rayPayloadEXT"},
    {"Q103", "quintet/stages/surface.rchit", "rayPayloadInEXT", "rayPayloadEXT"},
    {"Q103", "quintet/stages/alpha.rahit", "rayPayloadInEXT", "rayPayloadEXT"},
    {"Q103", "quintet/stages/procedural.rchit", "rayPayloadInEXT", "rayPayloadEXT"},
    {"Q104", "quintet/stages/shadow.rmiss", "payload.visible = 1u;", ""},
    {"Q104", "quintet/stages/surface.rchit", kSurfaceHit, ""},
    {"Q104", "quintet/stages/procedural.rchit", "payload = solidHit(raySeed(payload));", ""},
    {"Q104", "quintet/trace.glsl", "  shadowPayload.visible = 0u;\n", ""},
    {"Q101", "quintet/trace.glsl", "direction, tmax, 1);", "direction, tmax, 0);"},
    // Hit attributes.
    {"Q202", "quintet/stages/surface.rchit", "hitAttributeEXT vec2 baryCoord;",
     "hitAttributeEXT vec3 bary3;\n#define baryCoord bary3.xy"},
    {"Q202", "quintet/stages/alpha.rahit", "hitAttributeEXT vec2 baryCoord;",
     "hitAttributeEXT vec4 bary4;\n#define baryCoord bary4.xy"},
    {"Q202", "quintet/stages/alpha_shadow.rahit", "hitAttributeEXT vec2 baryCoord;",
     "hitAttributeEXT vec3 bary3;\n#define baryCoord bary3.yz"},
    {"Q203", "quintet/stages/solids.rint", "void main() {\n  const",
     "hitAttributeEXT vec3 wide[3];\nvoid main() {\n  wide[0] = vec3(1.0);\n  const"},
    // Recursion.
    {"Q401", "quintet/stages/surface.rchit", kSurfaceHit,
     "payload = triangleHit(baryCoord, raySeed(payload));\n  traceRayEXT(tlas, 0u, 0xFFu, 0u, 2u, 0u, vec3(0.0), 1e-3, "
     "vec3(1.0), 1.0, 1);"},
    // The table.
    {"Q501", "quintet/trace.glsl", "0xFFu, kRay_radiance,", "0xFFu, kRayTypeCount,"},
    {"Q501", "quintet/trace.glsl", "kRay_radiance, kRayTypeCount,", "kRay_radiance, kRayTypeCount + 1u,"},
    {"Q502", "quintet/trace.glsl", "kRayTypeCount, kMiss_radiance,", "kRayTypeCount, kRayTypeCount + 1u,"},
    {"Q502", "quintet/trace.glsl", "kMiss_shadow,", "kMiss_shadow + 1u,"},
    {"Q503", "quintet/trace.glsl", "kRay_radiance, kRayTypeCount,", "kRay_radiance, 32u,"},
    {"Q503", "quintet/trace.glsl", "0xFFu, kRay_radiance,", "0xFFu, 0x100u,"},
    {"Q504", "quintet/trace.glsl", "kMiss_shadow,", "0x10001u,"},
    {"Q505", "quintet/trace.glsl", "0xFFu, kRay_radiance", "0x100u, kRay_radiance"},
    {"Q505", "quintet/trace.glsl", "mask, kRay_shadow", "0xFFFFFFFFu, kRay_shadow"},
    {"Q101 Q506", "quintet/trace.glsl", "kMiss_shadow,", "kMiss_radiance,"},
    {"Q101", "quintet/trace.glsl", "mask, kRay_shadow", "mask, kRay_radiance"},
    // Geometry and flags.
    {"Q603 Q604", "quintet/trace.glsl", kRadianceTrace,
     "gl_RayFlagsOpaqueEXT, 0xFFu, kRay_radiance, kRayTypeCount, kMiss_radiance"},
    {"Q603 Q604", "quintet/trace.glsl", "gl_RayFlagsTerminateOnFirstHitEXT |",
     "gl_RayFlagsOpaqueEXT | gl_RayFlagsTerminateOnFirstHitEXT |"},
    {"Q605", "quintet/trace.glsl", kRadianceTrace,
     "gl_RayFlagsCullBackFacingTrianglesEXT | gl_RayFlagsCullFrontFacingTrianglesEXT, 0xFFu, kRay_radiance, "
     "kRayTypeCount, kMiss_radiance"},
    {"Q605", "quintet/trace.glsl", "gl_RayFlagsTerminateOnFirstHitEXT |",
     "gl_RayFlagsOpaqueEXT | gl_RayFlagsNoOpaqueEXT |"},
    // Within one stage.
    {"Q701", "quintet/stages/solids.rint", "gl_ObjectRayOriginEXT, gl_ObjectRayDirectionEXT",
     "gl_ObjectRayOriginEXT, normalize(gl_ObjectRayDirectionEXT)"},
    {"Q701", "quintet/stages/csg.rint", "const vec3 direction = gl_ObjectRayDirectionEXT;",
     "const vec3 direction = normalize(gl_ObjectRayDirectionEXT);"},
    {"Q704", "quintet/texture.glsl", "textures[nonuniformEXT(use.index)]", "textures[use.index]"},
    // Unused parts.
    {"Q801", "quintet/trace.glsl", "  return shadowPayload.visible != 0u;", "  return true;"},
};

std::string libraryText(const std::string& path) {
  for (const EmbeddedFile& file : embeddedShaderLibrary())
    if (file.path == path) return std::string(file.data);
  ADD_FAILURE() << "the library has no " << path;
  return {};
}

// Removes the trace of the shadow rays as well if its result is unused.
std::string mutated(const Mistake& mistake) {
  std::string text = libraryText(mistake.file);
  if (std::string_view(mistake.ids) == "Q801") {
    const std::size_t trace = text.find("  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT");
    EXPECT_NE(trace, std::string::npos);
    text.erase(trace, text.find(";\n", trace) + 2 - trace);
  }
  if (std::string_view(mistake.ids) == "Q401")
    text = changed(text, "hitAttributeEXT",
                   "layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT tlas;\n"
                   "layout(location = 1) rayPayloadEXT HitPayload inner;\nhitAttributeEXT");
  return changed(text, mistake.from, mistake.to);
}

bool has(const std::string& text, const std::string& ids) {
  for (std::size_t at = 0; at < ids.size(); at += 5)
    if (("\n" + text).find("\n" + ids.substr(at, 4) + " ") != std::string::npos) return true;
  return false;
}

TEST(LibraryMutation, FindsMistakes) {
  const test::TempFolder cache;  // unchanged stages are compiled once
  const shader::Compiler compiler([&] {
    shader::CompilerOptions options;
    options.cacheFolder = cache.path();
    return options;
  }());
  const program::SceneFacts scene = sceneWith({{program::GeometryKind::triangles, false, "rock", "stone"},
                                               {program::GeometryKind::triangles, true, "tree", "leaf"},
                                               {program::GeometryKind::solids, false, "balls", "glass"}});
  const std::vector<std::string> programs{"ao", "normals"};  // with shadow rays, and without
  std::string table, survivors;
  std::size_t total = 0, caught = 0;
  for (const std::string& name : programs)
    ASSERT_EQ(textOf(check(program::loadProgram(name), compiler, &scene, {})), "") << name;
  std::vector<std::string> texts(std::size(kLibraryMistakes) * programs.size());
  parallelFor(texts.size(), [&](std::size_t i) {
    const Mistake& mistake = kLibraryMistakes[i / programs.size()];
    program::Program program = program::loadProgram(programs[i % programs.size()]);
    program.files[fmt::format("<{}>", mistake.file)] = mutated(mistake);  // overrides the file of the library
    texts[i] = textOf(check(program, compiler, &scene, {}));
  });
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const Mistake& mistake = kLibraryMistakes[i / programs.size()];
    const bool shadow = std::string_view(mistake.from).find("hadow") != std::string_view::npos ||
                        std::string_view(mistake.file).find("shadow") != std::string_view::npos ||
                        std::string_view(mistake.from).find("Terminate") != std::string_view::npos ||
                        std::string_view(mistake.from).find("tmax, 1") != std::string_view::npos;
    if (i % programs.size() == 0)
      table += fmt::format(
          "\n{:<10}{:<36}{:<34.34}", mistake.ids, mistake.file,
          fmt::format("{}", std::string_view(mistake.from).substr(0, std::string_view(mistake.from).find('\n'))));
    if (shadow && i % programs.size() == 1) continue;  // no shadow rays
    ++total;
    const bool found = has(texts[i], mistake.ids);
    caught += found ? 1 : 0;
    table += fmt::format(" {}:{}", programs[i % programs.size()], found ? "found" : "MISSED");
    if (!found)
      survivors +=
          fmt::format("{} {} in {}:\n{}\n", mistake.ids, mistake.from, programs[i % programs.size()], texts[i]);
  }
  fmt::print("{}\n{} of {}\n", table, caught, total);
  EXPECT_GE(static_cast<double>(caught), 0.95 * static_cast<double>(total)) << survivors;
}

}  // namespace
}  // namespace quintet::check
