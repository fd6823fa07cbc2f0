// What a surface looks like: textures and factors of glTF's material evaluated at a point, the shading
// frame, and the emission.
#ifndef QUINTET_MATERIAL_GLSL
#define QUINTET_MATERIAL_GLSL

#include "bsdf/bsdf.glsl"
#include "surface.glsl"

struct Shading {
  BsdfParameters bsdf;
  vec3 normal;      // world, unit: z of the local frame, on the side of wo
  vec3 tangent;     // x
  vec3 bitangent;   // y
  vec3 emission;    // radiance towards wo (both sides emit)
  vec3 absorption;  // 1/m inside the solid
  bool unlit;       // emission is all there is
};

vec3 toLocal(Shading s, vec3 v) { return vec3(dot(v, s.tangent), dot(v, s.bitangent), dot(v, s.normal)); }
vec3 toWorld(Shading s, vec3 v) { return v.x * s.tangent + v.y * s.bitangent + v.z * s.normal; }

// Tangent-space normal of a normal texture, z up.
vec3 mappedNormal(TextureData use, vec2 uv, float scale) {
  vec3 n = 2.0 * sampleTexture(use, uv).xyz - 1.0;
  n.xy *= scale;
  return n;
}

// Bends n so that it is on wo's side and the mirror direction of wo stays above the geometric surface:
// no black borders on normal-mapped or coarsely tessellated surfaces, no light through them
// (Keller et al. 2017, "The Iray Light Transport Simulation and Rendering System", section A.3).
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

float textureOr(TextureData use, Surface s, int channel) {
  return use.index == kNoTexture ? 1.0 : sampleTexture(use, s.uvs[use.uvSet])[channel];
}

Shading shadeSurface(Surface s, vec3 wo) {
  const MaterialData m = MaterialArray(frame.materials).at[s.material];
  Shading r;
  vec4 base = m.baseColor * s.color;
  if (m.baseColorTexture.index != kNoTexture) base *= sampleTexture(m.baseColorTexture, s.uvs[m.baseColorTexture.uvSet]);
  r.unlit = (m.flags & kMaterialUnlit) != 0u;
  r.emission = m.emissive;
  if ((m.flags & kMaterialEmissive) != 0u && m.emissiveTexture.index != kNoTexture)
    r.emission *= sampleTexture(m.emissiveTexture, s.uvs[m.emissiveTexture.uvSet]).rgb;
  if (r.unlit) r.emission = base.rgb;

  vec2 roughMetal = vec2(m.roughness, m.metallic);
  if (m.metallicRoughnessTexture.index != kNoTexture)
    roughMetal *= sampleTexture(m.metallicRoughnessTexture, s.uvs[m.metallicRoughnessTexture.uvSet]).gb;
  r.bsdf.baseColor = clamp(base.rgb, 0.0, 1.0);
  r.bsdf.metallic = roughMetal.y;
  r.bsdf.alpha = roughMetal.x * roughMetal.x;
  r.bsdf.transmission = m.transmission * textureOr(m.transmissionTexture, s, 0);
  r.bsdf.ior = m.ior;
  r.bsdf.entering = s.frontFace;
  r.bsdf.thin = (m.flags & kMaterialThin) != 0u;
  r.bsdf.specular = m.specular * textureOr(m.specularTexture, s, 3);
  r.bsdf.specularColor = m.specularColor;
  if (m.specularColorTexture.index != kNoTexture)
    r.bsdf.specularColor *= sampleTexture(m.specularColorTexture, s.uvs[m.specularColorTexture.uvSet]).rgb;
  r.bsdf.clearcoat = m.clearcoat * textureOr(m.clearcoatTexture, s, 0);
  const float coatRoughness = m.clearcoatRoughness * textureOr(m.clearcoatRoughnessTexture, s, 1);
  r.bsdf.clearcoatAlpha = coatRoughness * coatRoughness;
  r.absorption = m.absorption;

  // Normal maps live in the frame of the front side; the whole frame turns for a back side.
  const float side = s.frontFace ? 1.0 : -1.0;
  vec3 n = side * s.shadingNormal;
  const vec3 front = n;
  if (m.normalTexture.index != kNoTexture) {
    const vec3 t = mappedNormal(m.normalTexture, s.uvs[m.normalTexture.uvSet], m.normalScale);
    n = safeNormalize(t.x * s.tangent + t.y * s.bitangent + t.z * front, front);
  }
  r.normal = consistentNormal(side * n, s.geometricNormal, wo);
  r.tangent = safeNormalize(s.tangent - r.normal * dot(r.normal, s.tangent), anyTangent(r.normal));
  r.bitangent = cross(r.normal, r.tangent);

  vec3 coat = front;
  if (r.bsdf.clearcoat > 0.0 && m.clearcoatNormalTexture.index != kNoTexture) {
    const vec3 t = mappedNormal(m.clearcoatNormalTexture, s.uvs[m.clearcoatNormalTexture.uvSet], m.clearcoatNormalScale);
    coat = safeNormalize(t.x * s.tangent + t.y * s.bitangent + t.z * front, front);
  }
  r.bsdf.clearcoatNormal = toLocal(r, consistentNormal(side * coat, s.geometricNormal, wo));
  return r;
}

#endif
