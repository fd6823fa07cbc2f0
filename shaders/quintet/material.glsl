// SPDX-License-Identifier: Apache-2.0
// The material of glTF evaluated at a surface point: textures and factors, the shading frame, and the emission.
#ifndef QUINTET_MATERIAL_GLSL
#define QUINTET_MATERIAL_GLSL

#include "bsdf/bsdf.glsl"
#include "bsdf/dispersion.glsl"
#include "features.glsl"
#include "shared/radiance.h"
#include "surface.glsl"

struct Shading {
  BsdfParameters bsdf;
  vec3 normal;      // world, unit: z of the local frame, on the side of wo
  vec3 tangent;     // x
  vec3 bitangent;   // y
  vec3 emission;    // radiance towards wo; both sides emit
  vec3 absorption;  // 1/m inside the solid
  bool unlit;       // the surface emits and does not scatter
};

vec3 toLocal(Shading s, vec3 v) { return vec3(dot(v, s.tangent), dot(v, s.bitangent), dot(v, s.normal)); }
vec3 toWorld(Shading s, vec3 v) { return v.x * s.tangent + v.y * s.bitangent + v.z * s.normal; }

// Bends n to wo's side, and so far that the mirror direction of wo stays above the geometric surface. So normal-mapped and
// coarsely tessellated surfaces have no black borders, and no light leaks through them (Keller et al. 2017, "The Iray Light
// Transport Simulation and Rendering System", section A.3).
vec3 consistentNormal(vec3 n, vec3 geometricNormal, vec3 wo) {
  const float least = 1e-3;
  const float facing = dot(n, wo);
  if (facing < least) n = normalize(n + (least - facing) * wo);
  const vec3 mirrored = 2.0 * dot(n, wo) * n - wo;
  const float height = dot(mirrored, geometricNormal);
  const float wanted = min(least, 0.5 * dot(wo, geometricNormal));
  if (height >= wanted) return n;
  return safeNormalize(wo + normalize(mirrored + (wanted - height) * geometricNormal), geometricNormal);
}

// Returns true if `slot` is this texture. False at compile time for textures that no material of the scene has.
bool isTexture(uint slot, uint texture) { return (kTextureSlots & (1u << texture)) != 0u && slot == texture; }
const bool kHasNormalMaps = (kTextureSlots & (1u << kTextureNormal | 1u << kTextureClearcoatNormal)) != 0u;

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer TextureArray { TextureData at[]; };

// Transforms a tangent-space direction (z up) to world space, in the frame of the front side.
vec3 fromTangentSpace(Surface s, vec3 front, vec3 t) {
  return safeNormalize(t.x * s.tangent + t.y * s.bitangent + t.z * front, front);
}

Shading shadeSurface(Surface s, vec3 wo) {
  MaterialArray materials = MaterialArray(frame.materials);
#define MATERIAL materials.at[s.material]
  Shading r;
  const uint flags = MATERIAL.flags;
  vec4 base = kHasVertexColors ? MATERIAL.baseColor * s.color : MATERIAL.baseColor;
  vec2 roughMetal = vec2(MATERIAL.roughness, MATERIAL.metallic);
  r.emission = MATERIAL.emissive;
  r.bsdf.transmission = MATERIAL.transmission;
  r.bsdf.specular = MATERIAL.specular;
  r.bsdf.specularColor = MATERIAL.specularColor;
  r.bsdf.clearcoat = MATERIAL.clearcoat;
  r.bsdf.sheenColor = MATERIAL.sheenColor;
  float sheenRoughness = MATERIAL.sheenRoughness;
  r.bsdf.diffuseTransmission = MATERIAL.diffuseTransmission;
  r.bsdf.diffuseTransmissionColor = MATERIAL.diffuseTransmissionColor;
  r.bsdf.anisotropy = MATERIAL.anisotropy;
  vec2 grain = vec2(1.0, 0.0);  // direction of the anisotropy in tangent space, before its rotation
  r.bsdf.iridescence = MATERIAL.iridescence;
  r.bsdf.iridescenceIor = MATERIAL.iridescenceIor;
  r.bsdf.iridescenceThickness = MATERIAL.iridescenceThicknessMaximum;
  r.bsdf.dispersion = MATERIAL.dispersion;
  r.bsdf.transmitted = vec3(1.0);
  float coatRoughness = MATERIAL.clearcoatRoughness;
  vec3 mapped = vec3(0.0, 0.0, 1.0);
  vec3 coatMapped = mapped;

  // A loop with one texture access, so that compilers that inline it (lavapipe) compile it once.
  TextureArray textureUses = TextureArray(frame.materials + uint64_t(s.material) * (kMaterialTextureOffset + kTextureCount * 32u) + kMaterialTextureOffset);
  for (uint left = (flags >> kMaterialTextureShift) & kTextureSlots; left != 0u; left &= left - 1u) {
    const uint slot = uint(findLSB(left));
    const TextureData use = textureUses.at[slot];
    const vec4 v = sampleTexture(use, use.uvSet == 0u ? s.uvs[0] : s.uvs[1]);
    if (isTexture(slot, kTextureBaseColor)) base *= v;
    else if (isTexture(slot, kTextureMetallicRoughness)) roughMetal *= v.gb;
    else if (isTexture(slot, kTextureNormal)) mapped = vec3(MATERIAL.normalScale * (2.0 * v.xy - 1.0), 2.0 * v.z - 1.0);
    else if (isTexture(slot, kTextureEmissive)) r.emission *= v.rgb;
    else if (isTexture(slot, kTextureTransmission)) r.bsdf.transmission *= v.r;
    else if (isTexture(slot, kTextureSpecular)) r.bsdf.specular *= v.a;
    else if (isTexture(slot, kTextureSpecularColor)) r.bsdf.specularColor *= v.rgb;
    else if (isTexture(slot, kTextureClearcoat)) r.bsdf.clearcoat *= v.r;
    else if (isTexture(slot, kTextureClearcoatRoughness)) coatRoughness *= v.g;
    else if (isTexture(slot, kTextureClearcoatNormal)) coatMapped = vec3(MATERIAL.clearcoatNormalScale * (2.0 * v.xy - 1.0), 2.0 * v.z - 1.0);
    else if (isTexture(slot, kTextureSheenColor)) r.bsdf.sheenColor *= v.rgb;
    else if (isTexture(slot, kTextureSheenRoughness)) sheenRoughness *= v.a;
    else if (isTexture(slot, kTextureDiffuseTransmission)) r.bsdf.diffuseTransmission *= v.a;
    else if (isTexture(slot, kTextureDiffuseTransmissionColor)) r.bsdf.diffuseTransmissionColor *= v.rgb;
    else if (isTexture(slot, kTextureAnisotropy)) {
      grain = 2.0 * v.xy - 1.0;
      r.bsdf.anisotropy *= v.b;
    } else if (isTexture(slot, kTextureIridescence)) r.bsdf.iridescence *= v.r;
    else if (isTexture(slot, kTextureIridescenceThickness)) {
      r.bsdf.iridescenceThickness = mix(MATERIAL.iridescenceThicknessMinimum, MATERIAL.iridescenceThicknessMaximum, v.g);
    }
  }

  r.unlit = (flags & kMaterialUnlit) != 0u;
  if (r.unlit) r.emission = base.rgb;
  // Textures with float values can leave the range of the parameters.
  r.bsdf.baseColor = clamp(base.rgb, 0.0, 1.0);
  r.bsdf.transmission = clamp(r.bsdf.transmission, 0.0, 1.0);
  r.bsdf.sheenColor = clamp(r.bsdf.sheenColor, 0.0, 1.0);
  r.bsdf.diffuseTransmission = clamp(r.bsdf.diffuseTransmission, 0.0, 1.0);
  r.bsdf.diffuseTransmissionColor = clamp(r.bsdf.diffuseTransmissionColor, 0.0, 1.0);
  r.bsdf.specular = clamp(r.bsdf.specular, 0.0, 1.0);
  r.bsdf.specularColor = max(r.bsdf.specularColor, 0.0);
  r.bsdf.clearcoat = clamp(r.bsdf.clearcoat, 0.0, 1.0);
  coatRoughness = clamp(coatRoughness, 0.0, 1.0);
  r.bsdf.anisotropy = clamp(r.bsdf.anisotropy, 0.0, 1.0);
  r.bsdf.iridescence = clamp(r.bsdf.iridescence, 0.0, 1.0);
  r.bsdf.iridescenceThickness = max(r.bsdf.iridescenceThickness, 0.0);
  roughMetal = clamp(roughMetal, 0.0, 1.0);
  r.bsdf.metallic = roughMetal.y;
  r.bsdf.alpha = roughMetal.x * roughMetal.x;
  r.bsdf.ior = MATERIAL.ior;
  r.bsdf.entering = s.frontFace;
  r.bsdf.thin = (flags & kMaterialThin) != 0u;
  r.bsdf.clearcoatAlpha = coatRoughness * coatRoughness;
  r.bsdf.sheenAlpha = min(sheenRoughness * sheenRoughness, 1.0);
  r.absorption = MATERIAL.absorption;
  const vec2 rotation = MATERIAL.anisotropyDirection;
  // The same factor as in lights/triangle.glsl for light samples.
  if (kHasClearcoat && !r.unlit) r.emission *= clearcoatPassed(r.bsdf.clearcoat, r.bsdf.clearcoatAlpha, abs(dot(s.shadingNormal, wo)));
  r.emission = clamp(r.emission, 0.0, kMaxRadiance);
#undef MATERIAL

  // Normal maps are defined in the frame of the front side. For a back side the whole frame is turned.
  const float side = s.frontFace ? 1.0 : -1.0;
  const vec3 front = side * s.shadingNormal;
  const vec3 wanted = kHasNormalMaps ? side * fromTangentSpace(s, front, mapped) : s.shadingNormal;
  r.normal = consistentNormal(wanted, s.geometricNormal, wo);
  // The tangent is the direction of the anisotropy. Isotropic lobes do not depend on it: without normal maps any tangent
  // works, and none is fetched.
  r.tangent = anyTangent(r.normal);
  vec3 along = s.tangent;
  if (kHasAnisotropy && r.bsdf.anisotropy > 0.0) {
    const vec2 turned = vec2(grain.x * rotation.x - grain.y * rotation.y, grain.x * rotation.y + grain.y * rotation.x);
    along = safeNormalize(turned.x * s.tangent + turned.y * s.bitangent, s.tangent);
  }
  if (kHasNormalMaps || (kHasAnisotropy && r.bsdf.anisotropy > 0.0))
    r.tangent = safeNormalize(along - r.normal * dot(r.normal, along), r.tangent);
  r.bitangent = cross(r.normal, r.tangent);
  r.bsdf.clearcoatNormal = vec3(0.0, 0.0, 1.0);
  if (kHasNormalMaps) r.bsdf.clearcoatNormal = toLocal(r, consistentNormal(side * fromTangentSpace(s, front, coatMapped), s.geometricNormal, wo));
  explainShading(r.normal, r.emission, r.bsdf.baseColor, r.bsdf.metallic, r.bsdf.alpha, r.bsdf.transmission, r.bsdf.ior, r.bsdf.clearcoat,
                 r.bsdf.sheenColor, r.bsdf.sheenAlpha, r.bsdf.diffuseTransmission, r.bsdf.anisotropy,
                 r.bsdf.iridescence, r.bsdf.iridescenceThickness, r.bsdf.dispersion, r.unlit);
  return r;
}

#endif
