// SPDX-License-Identifier: Apache-2.0
// Rays, payloads, and the two traces that the built-in programs use. A program that includes this file
// declares the ray types `radiance` and `shadow` in its program.toml; the constants kRay_…, kMiss_… and
// kRayTypeCount are generated from there.
#ifndef QUINTET_TRACE_GLSL
#define QUINTET_TRACE_GLSL

#include "explain_hooks.glsl"
#include "frame.glsl"
#include "payload.glsl"
#include <quintet/generated/program.glsl>
#ifdef QUINTET_INLINE_TRACES
#include "ray_query.glsl"
#endif

layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT HitPayload hitPayload;

#ifdef QUINTET_RECORD_RAYS
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer RayRecordArray { RayKinds kinds; RayRecord at[]; };
uint recordedRays = 0u;

// Counts the traced ray by its kind and stores it for the program `replay`; rays beyond the capacity are only counted.
void recordRay(vec3 origin, vec3 direction, float tmax, uint kind, bool hit) {
  RayRecordArray records = RayRecordArray(frame.rayRecords);
  if (kind == kRecordShadow) {
    atomicAdd(records.kinds.shadow, 1u);
    if (hit) atomicAdd(records.kinds.shadowHits, 1u);
  } else if (recordedRays == 0u) {
    atomicAdd(records.kinds.camera, 1u);
    if (hit) atomicAdd(records.kinds.cameraHits, 1u);
  } else {
    atomicAdd(records.kinds.continuation, 1u);
    if (hit) atomicAdd(records.kinds.continuationHits, 1u);
  }
  if (recordedRays >= frame.rayRecordCapacity) return;
  const uvec2 pixel = gl_LaunchIDEXT.xy + launch.offset - frame.filmOffset;
  const uint first = (pixel.y * frame.filmWidth + pixel.x) * frame.rayRecordCapacity;
  records.at[first + recordedRays++] = RayRecord(origin, tmax, direction, kind);
}
#endif

// The closest surface along origin + t · direction, t in (0, tmax). `seed` is for stochastic alpha.
HitPayload traceClosest(vec3 origin, vec3 direction, float tmax, uint seed) {
#ifdef QUINTET_INLINE_TRACES
  hitPayload = queryClosest(topLevelAS, origin, direction, tmax, seed);
#else
  hitPayload.t = -1.0;
  setRaySeed(hitPayload, seed);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_radiance, kRayTypeCount, kMiss_radiance, origin, 0.0, direction,
              tmax, 0);
#endif
#ifdef QUINTET_RECORD_RAYS
  recordRay(origin, direction, tmax, kRecordClosest, hitPayload.t >= 0.0);
#endif
  return hitPayload;
}

#ifdef QUINTET_SHADOW_RAYS
layout(location = 1) rayPayloadEXT ShadowPayload shadowPayload;

// True if no surface lies between t = 0 and tmax; `seed` is for stochastic alpha. tmax 0: no ray. If only some
// invocations have a ray, calling this from all of them is much faster (H200) than diverging here.
bool traceVisible(vec3 origin, vec3 direction, float tmax, uint seed) {
#ifdef QUINTET_INLINE_TRACES
  vec3 transmittance;
  shadowPayload.visible = queryVisible(topLevelAS, origin, direction, tmax, transmittance) ? 1u : 0u;
#ifndef QUINTET_NO_TRANSMITTANCE
  shadowPayload.transmittance = transmittance;
#endif
#else
  const uint mask = tmax > 0.0 ? 0xFFu : 0u;
  shadowPayload.visible = 0u;
  setRaySeed(shadowPayload, seed);
#ifndef QUINTET_NO_TRANSMITTANCE
  shadowPayload.transmittance = vec3(1.0);
#endif
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, mask, kRay_shadow,
              kRayTypeCount, kMiss_shadow, origin, 0.0, direction, tmax, 1);
#endif
#ifdef QUINTET_RECORD_RAYS
  if (tmax > 0.0) recordRay(origin, direction, tmax, kRecordShadow, shadowPayload.visible == 0u);
#endif
  return shadowPayload.visible != 0u;
}

// The fraction of the light at t = tmax that arrives undeflected at t = 0. Panes and alpha blend tint it, if the
// program uses the any-hit shader quintet/stages/transmittance.rahit; all other surfaces block it.
vec3 traceTransmittance(vec3 origin, vec3 direction, float tmax, uint seed) {
  const bool visible = traceVisible(origin, direction, tmax, seed);
#ifdef QUINTET_NO_TRANSMITTANCE
  explainVisibility(vec3(visible ? 1.0 : 0.0));
#else
  explainVisibility(visible ? shadowPayload.transmittance : vec3(0.0));
#endif
#ifndef QUINTET_NO_TRANSMITTANCE
  if (visible) return shadowPayload.transmittance;
#endif
  return vec3(visible ? 1.0 : 0.0);
}
#endif

#endif
