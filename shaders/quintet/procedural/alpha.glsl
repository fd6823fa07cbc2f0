// The alpha test of any-hit shaders on solids and trees. As quintet/alpha.glsl, its answer depends only on the ray's
// seed and on the surface, which it computes from the ray and the candidate's t.
#ifndef QUINTET_PROCEDURAL_ALPHA_GLSL
#define QUINTET_PROCEDURAL_ALPHA_GLSL

#include "../sampling/hash.glsl"
#include "../texture.glsl"
#include "hit.glsl"

// True if the candidate is not there: alpha mask below its cut-off, or blend with probability 1 - alpha.
bool solidAlphaRejects(uint seed) {
  const HitPayload hit = solidHit(seed);
  const PrimitiveData primitive = PrimitiveArray(hitGeometry().primitives).at[hit.part & kPartPrimitiveMask];
  const MaterialData material = MaterialArray(frame.materials).at[primitive.material];
  if ((material.flags & (kMaterialMask | kMaterialBlend)) == 0u) return false;
  float alpha = material.baseColor.a;
  if (material.baseColorTexture.index != kNoTexture) {
    const uint face = (hit.part >> kPartFaceShift) & 7u;
    alpha *= sampleTexture(material.baseColorTexture, solidPoint(primitive.type, primitive.parameter, face, hit.barycentric).uv).a;
  }
  if ((material.flags & kMaterialMask) != 0u) return alpha < material.alphaCutoff;
  // Independent of every other number of the path, and of the ray's other crossings of the same solid.
  const uint surface = hashCombine(hit.part, hit.primitive * 8u + hit.geometry);
  const uint random = hashCombine(hashCombine(seed, hit.instance), hashCombine(surface, floatBitsToUint(hit.t)));
  return float(random >> 8) * (1.0 / 16777216.0) >= alpha;
}

#endif
