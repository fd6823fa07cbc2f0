// SPDX-License-Identifier: Apache-2.0
// Alpha in any-hit shaders: the coverage of the surface, and the stochastic alpha test. The result of the test depends
// only on the ray's seed and on the surface point. Drivers may call any-hit twice for one candidate; both calls give
// the same result.
#ifndef QUINTET_ALPHA_GLSL
#define QUINTET_ALPHA_GLSL

#include "coverage.glsl"
#include "hit.glsl"
#include "sampling/hash.glsl"
#include "texture.glsl"

// Coverage of the candidate: 0 or 1 for alpha mask, alpha for blend, 1 for all other materials.
float alphaCoverage(vec2 barycentric) {
  const GeometryData geometry = hitGeometry();
  const MaterialData material = MaterialArray(frame.materials).at[geometry.material];
  const uvec3 v = Uvec3Array(geometry.triangles).at[hitTriangle(geometry)];
  const vec3 b = vec3(1.0 - barycentric.x - barycentric.y, barycentric);
  float alpha = material.baseColor.a;
  if (geometry.colors != 0ul) {
    Vec4Array colors = Vec4Array(geometry.colors);
    alpha *= dot(b, vec3(colors.at[v.x].a, colors.at[v.y].a, colors.at[v.z].a));
  }
  if (material.baseColorTexture.index != kNoTexture) {
    alpha *= sampleTexture(material.baseColorTexture, interpolateUv(geometry, v, b, material.baseColorTexture.uvSet)).a;
  }
  return coverageOf(material, alpha);
}

// True if the candidate must be ignored: alpha mask below its cutoff, or blend with probability 1 - alpha.
bool alphaRejects(vec2 barycentric, uint seed) {
  // Independent of all other random numbers of the path: a hash of the ray's seed and the primitive.
  const uint instance = hashCombine(seed, uint(gl_InstanceCustomIndexEXT));
  const uint random = hashCombine(hashCombine(instance, hitTriangle(hitGeometry())), uint(gl_GeometryIndexEXT));
  return float(random >> 8) * (1.0 / 16777216.0) >= alphaCoverage(barycentric);
}

#endif
