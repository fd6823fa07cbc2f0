// SPDX-License-Identifier: Apache-2.0
// Built-ins that a closest-hit shader reads after a nested trace are those of its own hit. On drivers that overwrite them
// (Quirks::changesNestedBuiltIns), linking works around the defect.
#include "run_program.h"

namespace quintet::test {
namespace {

const std::string kNestedToml = R"([program]
ray_generation = "main.rgen"
max_recursion = 2

[[ray]]
name = "primary"
miss = "miss.rmiss"

[[hit_group]]
name = "all"
primary = { closest_hit = "hit.rchit" }

[[output]]
name = "outer"
[[output]]
name = "inner"
[[output]]
name = "parts"
)";

// The outer ray hits square x, the inner one square 2.
const Files kNestedFiles = {
    {"data.glsl", "struct Data { vec4 names; vec4 inner; vec3 parts; int depth; };\n"},
    {"hit.rchit", R"(#include <quintet/generated/program.glsl>
#include <quintet/shared/bindings.h>
#include "data.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Data data;
layout(location = 1) rayPayloadEXT Data nested;
void main() {
  nested.names = vec4(0.0);
  nested.depth = data.depth + 1;
  if (data.depth == 0)
    traceRayEXT(topLevelAS, 0u, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary, vec3(4.25, 0.75, 1.0), 0.0, vec3(0.0, 0.0, -1.0), 10.0, 1);
  data.inner = nested.names;
  data.names = vec4(gl_InstanceCustomIndexEXT, gl_PrimitiveID, gl_GeometryIndexEXT, gl_HitKindEXT);
  data.parts = vec3(gl_ObjectToWorldEXT[3].x, (gl_WorldToObjectEXT * vec4(0.0, 0.0, 0.0, 1.0)).x, gl_ObjectToWorldEXT[2].z);
}
)"},
    {"miss.rmiss",
     "#include \"data.glsl\"\nlayout(location = 0) rayPayloadInEXT Data data;\n"
     "void main() { data = Data(vec4(-1.0), vec4(-1.0), vec3(-1.0), data.depth); }\n"},
    {"main.rgen", R"(#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
#include "data.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT Data data;
void main() {
  const uvec2 pixel = launchPixel();
  data.depth = 0;
  const vec3 origin = vec3(2.0 * float(pixel.x) + 0.75, 0.25, 1.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary, origin, 0.0, vec3(0.0, 0.0, -1.0), 10.0, 0);
  storeOutput(kOutput_outer, pixel, data.names);
  storeOutput(kOutput_inner, pixel, data.inner);
  storeOutput(kOutput_parts, pixel, vec4(data.parts, 1.0));
}
)"},
};

// Returns unit squares in z = 0 at x = 0, 2 and 4, translated by their instances; the last one is also scaled in z.
SceneBuilder placedSquares() {
  SceneBuilder builder;
  for (int i = 0; i < 3; ++i) {
    mat4 worldFromObject(1.0f);
    worldFromObject[3].x = 2.0f * static_cast<float>(i);
    worldFromObject[2].z = i == 2 ? 5.0f : 1.0f;
    builder.add(quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), lambert(vec3(0.5f)), worldFromObject);
  }
  builder.camera(perspective({0, 0, 5}, {0, 0, 0}, 40.0f));
  return builder;
}

TEST(NestedTrace, KeepsTheBuiltInsOfTheOuterHit) {
  const Outputs outputs = runProgram(kNestedToml, kNestedFiles, placedSquares(), 3);
  // The inner ray hits the last square in the triangle that the outer ray does not hit.
  const vec4 inner = outputs[1][0];
  EXPECT_EQ(inner.x, 2.0f);
  for (std::size_t x = 0; x < 3; ++x) {
    EXPECT_EQ(outputs[1][x], inner);
    EXPECT_EQ(outputs[0][x].x, static_cast<float>(x)) << "instance";
    EXPECT_EQ(outputs[0][x].y, 1.0f - inner.y) << "primitive";
    EXPECT_EQ(outputs[0][x].w, 254.0f) << "hit kind, front face";
    EXPECT_EQ(outputs[2][x],
              vec4(2.0f * static_cast<float>(x), -2.0f * static_cast<float>(x), x == 2 ? 5.0f : 1.0f, 1.0f));
  }
}

}  // namespace
}  // namespace quintet::test
