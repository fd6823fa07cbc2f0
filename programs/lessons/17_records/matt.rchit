// SPDX-License-Identifier: Apache-2.0
// A diffuse surface in the sun. Color and stripes come from the record of the hit group.
#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit.glsl>
#include <quintet/surface.glsl>
#include <quintet/generated/program.glsl>
#include <quintet/generated/record.glsl>
#include "payloads.glsl"

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT Radiance radiance;
layout(location = 1) rayPayloadEXT Transmittance transmittance;
layout(location = 2) rayPayloadEXT Distance free;
hitAttributeEXT vec2 baryCoord;

const vec3 toSun = vec3(0.48, 0.8, 0.36);  // unit

void main() {
  const Surface surface = fetchSurface(triangleHit(baryCoord, 0u), -gl_WorldRayDirectionEXT);
  vec3 base = record.tint;
  if (record.stripes > 0.0 && fract(surface.position.y * record.stripes) < 0.5) base *= 0.4;

  // Foil on the way runs its any-hit shader, because its geometry is not opaque.
  transmittance = Transmittance(vec3(1.0), false);
  traceRayEXT(topLevelAS, gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_shadow, kRayTypeCount, kMiss_shadow,
              offsetOrigin(surface, toSun), 0.0, toSun, kInfinity, 1);
  const vec3 sun = transmittance.reachedLight ? transmittance.value : vec3(0.0);

  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, 0xFFu, kRay_inside, kRayTypeCount, kMiss_inside,
              offsetOrigin(surface, surface.geometricNormal), 0.0, surface.geometricNormal, kInfinity, 2);
  radiance.color = base * (0.2 + 0.8 * sun * max(dot(surface.shadingNormal, toSun), 0.0));
  radiance.free = free.t;
}
