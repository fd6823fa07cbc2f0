// The alpha test of any-hit shaders. Its answer depends only on the ray's seed and on the surface point,
// so that calling it twice for one candidate (as drivers may) changes nothing.
#ifndef QUINTET_ALPHA_GLSL
#define QUINTET_ALPHA_GLSL

#include "hit.glsl"
#include "sampling/hash.glsl"
#include "texture.glsl"

// True if the candidate is not there: alpha mask below its cut-off, or blend with probability 1 - alpha.
bool alphaRejects(vec2 barycentric, uint seed) {
  const GeometryData geometry = hitGeometry();
  const MaterialData material = MaterialArray(frame.materials).at[geometry.material];
  const uint triangle = hitTriangle(geometry);
  const uvec3 v = Uvec3Array(geometry.triangles).at[triangle];
  const vec3 b = vec3(1.0 - barycentric.x - barycentric.y, barycentric);
  float alpha = material.baseColor.a;
  if (geometry.colors != 0ul) {
    Vec4Array colors = Vec4Array(geometry.colors);
    alpha *= dot(b, vec3(colors.at[v.x].a, colors.at[v.y].a, colors.at[v.z].a));
  }
  if (material.baseColorTexture.index != kNoTexture) {
    alpha *= sampleTexture(material.baseColorTexture, interpolateUv(geometry, v, b, material.baseColorTexture.uvSet)).a;
  }
  if ((material.flags & kMaterialMask) != 0u) return alpha < material.alphaCutoff;
  // Independent of every other number of the path: the ray's own seed, mixed with the primitive's identity.
  const uint random = hashCombine(hashCombine(seed, uint(gl_InstanceCustomIndexEXT)), triangle * 8u + uint(gl_GeometryIndexEXT));
  return float(random >> 8) * (1.0 / 16777216.0) >= alpha;
}

#endif
