// SPDX-License-Identifier: Apache-2.0
// Coverage of a surface from its alpha and the alpha mode of its material, and the stochastic alpha test. The result of the
// test depends only on the ray's seed and on the surface point. Drivers may test one candidate twice; both tests give the same
// result.
#ifndef QUINTET_COVERAGE_GLSL
#define QUINTET_COVERAGE_GLSL

#include "hit_indices.glsl"
#include "sampling/hash.glsl"
#include "texture.glsl"

// Coverage in [0,1]: 0 or 1 for alpha mask, alpha for blend, 1 for all other materials.
float coverageOf(MaterialData material, float alpha) {
  if ((material.flags & kMaterialMask) != 0u) return alpha < material.alphaCutoff ? 0.0 : 1.0;
  return (material.flags & kMaterialBlend) != 0u ? clamp(alpha, 0.0, 1.0) : 1.0;
}

// Coverage of a candidate, a triangle.
float triangleCoverage(HitIndices candidate, vec2 barycentric) {
  const GeometryData geometry = geometryOf(candidate.instance, candidate.geometry);
  const MaterialData material = MaterialArray(frame.materials).at[geometry.material];
  const uvec3 v = Uvec3Array(geometry.triangles).at[scenePrimitive(geometry, candidate.primitive)];
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
bool triangleRejected(HitIndices candidate, vec2 barycentric, uint seed) {
  // Independent of all other random numbers of the path: a hash of the ray's seed and the primitive.
  const uint primitive = scenePrimitive(geometryOf(candidate.instance, candidate.geometry), candidate.primitive);
  const uint random = hashCombine(hashCombine(hashCombine(seed, candidate.instance), primitive), candidate.geometry);
  return unitFloat(random) >= triangleCoverage(candidate, barycentric);
}

#endif
