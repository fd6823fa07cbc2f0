// SPDX-License-Identifier: Apache-2.0
#include "probe.h"

#include <bit>

#include <gtest/gtest.h>

#include "harness.h"
#include "program/description/parser.h"
#include "render/rendered_image.h"

namespace quintet::test {
namespace {

constexpr const char* kDescription = R"(
[program]
ray_generation = "probe.rgen"
[[ray]]
name = "radiance"
miss = "<quintet/stages/radiance.rmiss>"
[[ray]]
name = "shadow"
miss = "<quintet/stages/shadow.rmiss>"
[[hit_group]]
name = "triangles"
geometry = "triangles"
radiance = { closest_hit = "<quintet/stages/surface.rchit>" }
[[hit_group]]
name = "solids"
geometry = "solids"
radiance = { intersection = "<quintet/stages/solids.rint>", closest_hit = "<quintet/stages/procedural.rchit>" }
shadow = { intersection = "<quintet/stages/solids.rint>" }
[[hit_group]]
name = "csg"
geometry = "csg"
radiance = { intersection = "<quintet/stages/csg.rint>", closest_hit = "<quintet/stages/procedural.rchit>" }
shadow = { intersection = "<quintet/stages/csg.rint>" }
[[output]]
name = "ids"
[[output]]
name = "more"
[[output]]
name = "position"
[[output]]
name = "normal"
[[output]]
name = "shading"
[[output]]
name = "tangent"
[[output]]
name = "bitangent"
)";

constexpr const char* kRayGeneration = R"(#version 460
#extension GL_EXT_ray_tracing : require
#define QUINTET_SHADOW_RAYS
#include <quintet/output.glsl>
#include <quintet/surface.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT HitPayload payload;
layout(location = 1) rayPayloadEXT ShadowPayload shadow;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer RayRecordArray { RayRecord at[]; };

void main() {
  const uvec2 pixel = launchPixel();
  const RayRecord ray = RayRecordArray(frame.rayRecords).at[pixelIndex(pixel)];
  const float tmin = uintBitsToFloat(ray.kind);
  payload.t = -1.0;
  setRaySeed(payload, pixelIndex(pixel));
  traceRayEXT(topLevelAS, 0u, 0xFFu, kRay_radiance, kRayTypeCount, kMiss_radiance, ray.origin, tmin, ray.direction, ray.tmax, 0);
  shadow.visible = 0u;
  setRaySeed(shadow, pixelIndex(pixel));
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow, kRayTypeCount,
              kMiss_shadow, ray.origin, tmin, ray.direction, ray.tmax, 1);
  countRays(pixel, 2u, 0u);
  storeOutput(kOutput_ids, pixel, vec4(payload.t, 0.0, 0.0, shadow.visible));
  if (payload.t < 0.0) return;
  uint part = 0u;
#ifndef QUINTET_NO_PROCEDURALS
  part = payload.part;
#endif
  const Surface s = fetchSurface(payload, -normalize(ray.direction));
  storeOutput(kOutput_ids, pixel, vec4(payload.t, payload.instance, payload.primitive, shadow.visible));
  storeOutput(kOutput_more, pixel, vec4(part & 0x07FFFFFFu, (part >> 27) & 7u, part >> 30, s.material));
  storeOutput(kOutput_position, pixel, vec4(s.position, s.error));
  storeOutput(kOutput_normal, pixel, vec4(s.geometricNormal, s.frontFace ? 1.0 : 0.0));
  storeOutput(kOutput_shading, pixel, vec4(s.shadingNormal, 0.0));
  storeOutput(kOutput_tangent, pixel, vec4(s.tangent, s.uvs[0].x));
  storeOutput(kOutput_bitangent, pixel, vec4(s.bitangent, s.uvs[0].y));
})";

ProbeHit makeHit(const std::array<std::vector<vec4>, 7>& outputs, std::size_t i) {
  const auto at = [&](std::size_t output) { return outputs[output][i]; };
  ProbeHit hit;
  hit.t = at(0).x;
  hit.instance = static_cast<std::uint32_t>(at(0).y);
  hit.primitive = static_cast<std::uint32_t>(at(0).z);
  hit.visible = at(0).w != 0.0f;
  hit.leaf = static_cast<std::uint32_t>(at(1).x);
  hit.face = static_cast<std::uint32_t>(at(1).y);
  hit.flipped = (static_cast<std::uint32_t>(at(1).z) & 1u) != 0;
  hit.material = static_cast<std::uint32_t>(at(1).w);
  hit.position = at(2);
  hit.error = at(2).w;
  hit.normal = at(3);
  hit.front = at(3).w != 0.0f;
  hit.shadingNormal = at(4);
  hit.tangent = at(5);
  hit.bitangent = at(6);
  hit.uv = {at(5).w, at(6).w};
  return hit;
}

}  // namespace

std::vector<ProbeHit> probe(const scene::Scene& scene, const std::vector<ProbeRay>& rays) {
  constexpr std::uint32_t kWidth = 64;
  const auto height = static_cast<std::uint32_t>((rays.size() + kWidth - 1) / kWidth);
  std::vector<shared::RayRecord> records(std::size_t{kWidth} * height);
  for (std::size_t i = 0; i < records.size(); ++i) {
    const ProbeRay& ray = rays[i < rays.size() ? i : 0];
    records[i] = {ray.origin, ray.tmax, ray.direction, std::bit_cast<std::uint32_t>(ray.tmin)};
  }
  const gpu::Buffer buffer = gpu::makeBufferOf(testContext(), records, 0, "rays");
  render::DeviceScene device(testContext(), scene::Scene(scene), scene::Environment{});
  ImageOptions options;
  options.program = program::parseProgram(kDescription, "probe", "<test>", {{"probe.rgen", kRayGeneration}});
  options.width = kWidth;
  options.height = height;
  render::RenderSettings settings = settingsFor(scene::Camera{}, options);
  settings.rayRecords = &buffer;
  settings.rayRecordCapacity = 1;
  render::Renderer renderer = makeRenderer(device, options.program, settings);
  renderer.renderBatch(1);
  std::array<std::vector<vec4>, 7> outputs;
  for (std::size_t i = 0; i < outputs.size(); ++i) outputs[i] = renderer.film().downloadBatch(i);
  std::vector<ProbeHit> hits;
  for (std::size_t i = 0; i < rays.size(); ++i) hits.push_back(makeHit(outputs, i));
  return hits;
}

vec3 leave(const ProbeHit& hit, const vec3& direction) {
  return hit.position + (glm::dot(direction, hit.normal) < 0.0f ? -hit.error : hit.error) * hit.normal;
}

scene::Scene sceneOf(const scene::PrimitiveSet& set, const mat4& worldFromObject) {
  scene::Scene scene;
  scene.meshes.emplace_back().primitiveSets.push_back(set);
  scene::Instance& instance = scene.instances.emplace_back();
  instance.mesh = 0;
  instance.worldFromObject = worldFromObject;
  return scene;
}

scene::PrimitiveSet solidsOf(const std::vector<scene::Primitive>& primitives) {
  scene::PrimitiveSet set;
  set.primitives = primitives;
  return set;
}

float Random::uniform(float low, float high) {
  return low + (high - low) * static_cast<float>(engine_() >> 8) * (1.0f / 16777216.0f);
}
std::uint32_t Random::below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_() % n); }
vec3 Random::inBox(float halfSize) {
  const float x = uniform(-halfSize, halfSize), y = uniform(-halfSize, halfSize), z = uniform(-halfSize, halfSize);
  return {x, y, z};
}
vec3 Random::onSphere() {
  const float y = uniform(-1.0f, 1.0f), phi = uniform(0.0f, 2.0f * kPi), r = std::sqrt(1.0f - y * y);
  return {r * std::cos(phi), y, r * std::sin(phi)};
}
mat4 Random::rotation() {
  const vec3 axis = onSphere();
  return glm::rotate(mat4(1.0f), uniform(0.0f, 2.0f * kPi), axis);
}
mat4 Random::affine(float stretch, float distance) {
  vec3 scale;
  for (int i = 0; i < 3; ++i) scale[i] = std::exp(uniform(-std::log(stretch), std::log(stretch)));
  if (below(2) == 1) scale[static_cast<int>(below(3))] *= -1.0f;
  const mat4 first = rotation(), second = rotation();
  return glm::translate(mat4(1.0f), inBox(distance)) * first * glm::scale(mat4(1.0f), scale) * second;
}

}  // namespace quintet::test
