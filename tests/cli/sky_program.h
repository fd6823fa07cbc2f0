// SPDX-License-Identifier: Apache-2.0
// A small program in a folder: a sky without surfaces, whose color is set by one line of sky.rmiss.
#ifndef QUINTET_TESTS_CLI_SKY_PROGRAM_H
#define QUINTET_TESTS_CLI_SKY_PROGRAM_H

#include "fixtures.h"

namespace quintet::test {

// The miss shader. `line` becomes line 6: "payload.color = vec3(0.5);".
inline std::string skyMiss(const std::string& line) {
  return "#version 460\n#extension GL_EXT_ray_tracing : require\n#include \"payload.glsl\"\n"
         "layout(location = 0) rayPayloadInEXT Payload payload;\nvoid main() {\n  " +
         line + "\n}\n";
}

inline std::string skyToml(const std::string& miss) {
  return "[program]\ndescription = \"sky\"\nray_generation = \"sky.rgen\"\n"
         "[[ray]]\nname = \"primary\"\nmiss = \"" +
         miss + "\"\n";
}

inline void writeSkyProgram(const std::filesystem::path& folder, const std::string& line) {
  std::filesystem::create_directories(folder);
  write(folder / "program.toml", skyToml("sky.rmiss"));
  write(folder / "payload.glsl", "struct Payload {\n  vec3 color;\n};\n");
  write(folder / "sky.rmiss", skyMiss(line));
  write(folder / "sky.rgen", R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/camera.glsl>
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT Payload payload;
void main() {
  const uvec2 pixel = launchPixel();
  const Ray ray = cameraRay(vec2(pixel) + 0.5, vec2(0.5));
  payload.color = vec3(0.0);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary,
              ray.origin, 0.0, ray.direction, kInfinity, 0);
  storeOutput(kOutput_color, pixel, loadOutput(kOutput_color, pixel) + vec4(payload.color, 1.0));
}
)");
}

}  // namespace quintet::test
#endif
