// SPDX-License-Identifier: Apache-2.0
// Payloads and callable data of any type at any location: three payloads, two ray types and an additional miss shader, a
// trace from a closest-hit shader, and callables with data at two locations.
#include "run_program.h"

namespace quintet::test {
namespace {

const std::string kPayloadsToml = R"([program]
ray_generation = "main.rgen"

[[ray]]
name = "radiance"
miss = "sky.rmiss"

[[ray]]
name = "shadow"
miss = "lit.rmiss"

[[miss]]
name = "probe"
file = "probe.rmiss"

[[callable]]
name = "square"
file = "square.rcall"

[[callable]]
name = "swap"
file = "swap.rcall"

[[hit_group]]
name = "floor"
material = "floor"
radiance = { closest_hit = "floor.rchit" }
shadow = { any_hit = "count.rahit" }

[[hit_group]]
name = "roof"
material = "roof"
radiance = { closest_hit = "roof.rchit" }
shadow = { any_hit = "count.rahit" }

[[output]]
name = "color"
[[output]]
name = "more"
)";

const Files kPayloadsFiles = {
    {"types.glsl", R"(#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
struct Radiance { vec3 color; float t; uint depth; };
struct Shadow { bool lit; int hits[3]; };
struct Inner { vec2 a; mat2 m; };
struct Probe { uint64_t far; Inner inner; };
)"},
    // Each payload at its own location: 0, 3, 7.
    {"main.rgen", R"(#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
#include "types.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT Radiance radiance;
layout(location = 3) rayPayloadEXT Shadow shadow;
layout(location = 7) rayPayloadEXT Probe probe;
layout(location = 1) callableDataEXT float number;
layout(location = 4) callableDataEXT ivec2 pair;
void main() {
  const uvec2 pixel = launchPixel();
  const uint x = pixel.x;
  vec4 color = vec4(0.0), more = vec4(0.0);
  if (x < 3u) {
    // Down to the floor left of the roof, to the floor below the roof, and beside the floor.
    radiance.color = vec3(0.0);
    radiance.t = -1.0;
    radiance.depth = 1u;
    const vec3 origin = x == 0u ? vec3(0.5, 1.0, 0.5) : x == 1u ? vec3(2.5, 1.0, 0.5) : vec3(-5.0, 1.0, 0.5);
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_radiance, kRayTypeCount, kMiss_radiance, origin, 0.0, vec3(0, -1, 0), 50.0, 0);
    color = vec4(radiance.color, radiance.t);
    more.x = float(radiance.depth);
  } else if (x == 3u) {
    shadow.lit = false;
    shadow.hits = int[3](10, 20, 30);
    traceRayEXT(topLevelAS, gl_RayFlagsNoOpaqueEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow, kRayTypeCount, kMiss_shadow,
                vec3(2.5, 1.0, 0.5), 0.0, vec3(0, 1, 0), 50.0, 3);
    color = vec4(shadow.lit, shadow.hits[0], shadow.hits[1], shadow.hits[2]);
  } else if (x == 4u) {
    probe.far = 0x100000001ul;
    probe.inner.a = vec2(1.0, 2.0);
    probe.inner.m = mat2(1.0, 2.0, 3.0, 4.0);
    traceRayEXT(topLevelAS, gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_radiance, kRayTypeCount, kMiss_probe, vec3(0, 100, 0), 0.0, vec3(0, 1, 0), 50.0, 7);
    color = vec4(probe.inner.m[0], probe.inner.m[1]);
    more = vec4(probe.inner.a, float(uint(probe.far >> 32)), float(uint(probe.far)));
  } else {
    number = 1.5;
    pair = ivec2(3, -4);
    executeCallableEXT(kCallable_square, 1);
    executeCallableEXT(kCallable_swap, 4);
    color = vec4(number, pair, 0.0);
  }
  storeOutput(kOutput_color, pixel, color);
  storeOutput(kOutput_more, pixel, more);
}
)"},
    // Traces a shadow ray with its own payload and keeps the values of its incoming payload.
    {"floor.rchit", R"(#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
#include "types.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Radiance radiance;
layout(location = 3) rayPayloadEXT Shadow shadow;
void main() {
  const float t = gl_HitTEXT;
  const vec3 point = gl_WorldRayOriginEXT + t * gl_WorldRayDirectionEXT;
  shadow.lit = false;
  shadow.hits = int[3](0, 0, 0);
  traceRayEXT(topLevelAS, gl_RayFlagsNoOpaqueEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow, kRayTypeCount, kMiss_shadow,
              point, 0.01, vec3(0, 1, 0), 50.0, 3);
  radiance.color = shadow.lit ? vec3(1.0, 0.5, 0.25) : vec3(0.125 * float(shadow.hits[1]), 0.0, 0.0);
  radiance.t = t;
  radiance.depth += 10u;
}
)"},
    {"roof.rchit", R"(#include "types.glsl"
layout(location = 0) rayPayloadInEXT Radiance radiance;
void main() { radiance.color = vec3(9.0); }
)"},
    {"count.rahit", R"(#include "types.glsl"
layout(location = 3) rayPayloadInEXT Shadow shadow;
void main() { shadow.hits[1] = 2; }
)"},
    {"lit.rmiss", R"(#include "types.glsl"
layout(location = 3) rayPayloadInEXT Shadow shadow;
void main() { shadow.lit = true; shadow.hits[2]++; }
)"},
    {"sky.rmiss", R"(#include "types.glsl"
layout(location = 0) rayPayloadInEXT Radiance radiance;
void main() { radiance.color = vec3(0.0, 0.0, 4.0); radiance.depth *= 5u; }
)"},
    {"probe.rmiss", R"(#include "types.glsl"
layout(location = 7) rayPayloadInEXT Probe probe;
void main() {
  probe.inner.m = transpose(probe.inner.m) * 2.0;
  probe.inner.a = probe.inner.a.yx;
  probe.far += 0x200000003ul;
}
)"},
    {"square.rcall", "layout(location = 1) callableDataInEXT float number;\nvoid main() { number *= number; }\n"},
    {"swap.rcall", "layout(location = 4) callableDataInEXT ivec2 pair;\nvoid main() { pair = pair.yx; }\n"},
};

// Returns a floor from x = 0 to 4 and a roof above its right half.
SceneBuilder floorAndRoof() {
  SceneBuilder builder;
  builder.add(quad({0, 0, 1}, {4, 0, 0}, {0, 0, -1}), lambert(vec3(0.5f)));
  builder.scene.materials.back().name = "floor";
  builder.add(quad({2, 3, 1}, {2, 0, 0}, {0, 0, -1}), lambert(vec3(0.5f)));
  builder.scene.materials.back().name = "roof";
  builder.camera(perspective({0, 0, 5}, {0, 0, 0}, 40.0f));
  return builder;
}

TEST(Payloads, HaveAnyTypeAtAnyLocation) {
  const Outputs outputs = runProgram(kPayloadsToml, kPayloadsFiles, floorAndRoof(), 6);
  EXPECT_EQ(outputs[0][0], vec4(1.0f, 0.5f, 0.25f, 1.0f)) << "lit floor";
  EXPECT_EQ(outputs[1][0].x, 11.0f);
  EXPECT_EQ(outputs[0][1], vec4(0.25f, 0.0f, 0.0f, 1.0f)) << "floor below the roof; its any-hit shader ran";
  EXPECT_EQ(outputs[1][1].x, 11.0f);
  EXPECT_EQ(outputs[0][2], vec4(0.0f, 0.0f, 4.0f, -1.0f)) << "sky";
  EXPECT_EQ(outputs[1][2].x, 5.0f);
  EXPECT_EQ(outputs[0][3], vec4(0.0f, 10.0f, 2.0f, 30.0f)) << "shadow ray of the ray generation shader";
  EXPECT_EQ(outputs[0][4], vec4(2.0f, 6.0f, 4.0f, 8.0f)) << "additional miss shader";
  EXPECT_EQ(outputs[1][4], vec4(2.0f, 1.0f, 3.0f, 4.0f));
  EXPECT_EQ(outputs[0][5], vec4(2.25f, -4.0f, 3.0f, 0.0f)) << "two callables";
}

}  // namespace
}  // namespace quintet::test
