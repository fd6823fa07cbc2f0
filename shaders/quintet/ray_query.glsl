// SPDX-License-Identifier: Apache-2.0
// The traces of trace.glsl by ray queries: the hit and miss shaders of the library as functions. On lavapipe, a trace that calls
// shaders stores the state of the ray generation shader in memory: ray queries take up to 28 % less time (docs/design/quirks.md).
// Requires a scene of triangles without panes.
#ifndef QUINTET_RAY_QUERY_GLSL
#define QUINTET_RAY_QUERY_GLSL

#extension GL_EXT_ray_query : require
#include "coverage.glsl"
#include "triangle_hit.glsl"

#ifdef QUINTET_NO_SEEDS
const uint kQueryFlags = gl_RayFlagsOpaqueEXT;
#else
const uint kQueryFlags = gl_RayFlagsNoneEXT;
#endif

// Indices and barycentrics of the candidate.
HitIndices candidateOf(rayQueryEXT query, out vec2 barycentric) {
  barycentric = rayQueryGetIntersectionBarycentricsEXT(query, false);
  return HitIndices(uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, false)),
                    uint(rayQueryGetIntersectionGeometryIndexEXT(query, false)),
                    uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false)));
}

// The closest surface, as stages/surface.rchit, stages/alpha.rahit and stages/radiance.rmiss report it.
HitPayload queryClosest(accelerationStructureEXT structure, vec3 origin, vec3 direction, float tmax, uint seed) {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, structure, kQueryFlags, 0xFFu, origin, 0.0, direction, tmax);
  while (rayQueryProceedEXT(query)) {
#ifndef QUINTET_NO_SEEDS
    vec2 barycentric;
    const HitIndices candidate = candidateOf(query, barycentric);
    if (!triangleRejected(candidate, barycentric, seed)) rayQueryConfirmIntersectionEXT(query);
#endif
  }
  if (rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT) return hitAt(-1.0, uvec3(0u), seed);
  const HitIndices at = HitIndices(uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, true)),
                                   uint(rayQueryGetIntersectionGeometryIndexEXT(query, true)),
                                   uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, true)));
  return triangleHitAt(at, rayQueryGetIntersectionTEXT(query, true), rayQueryGetIntersectionBarycentricsEXT(query, true),
                       rayQueryGetIntersectionObjectRayOriginEXT(query, true),
                       rayQueryGetIntersectionObjectRayDirectionEXT(query, true), seed);
}

// Returns whether light arrives, as stages/transmittance.rahit and stages/shadow.rmiss report it. If true,
// `transmittance` is the fraction that arrives.
bool queryVisible(accelerationStructureEXT structure, vec3 origin, vec3 direction, float tmax, out vec3 transmittance) {
  transmittance = vec3(1.0);
  if (!(tmax > 0.0)) return true;  // no ray
  rayQueryEXT query;
  rayQueryInitializeEXT(query, structure, kQueryFlags | gl_RayFlagsTerminateOnFirstHitEXT, 0xFFu, origin, 0.0, direction, tmax);
  while (rayQueryProceedEXT(query)) {
#ifndef QUINTET_NO_SEEDS
    vec2 barycentric;
    const HitIndices candidate = candidateOf(query, barycentric);
    transmittance *= 1.0 - triangleCoverage(candidate, barycentric);
    if (maxComponent(transmittance) <= 0.0) rayQueryConfirmIntersectionEXT(query);
#endif
  }
  return rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT;
}

#endif
