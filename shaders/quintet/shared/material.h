// SPDX-License-Identifier: Apache-2.0
// Materials on the device (scene::Material documents meaning, units and ranges).
#ifndef QUINTET_SHARED_MATERIAL_H
#define QUINTET_SHARED_MATERIAL_H

#include "types.h"

QT_SHARED_BEGIN

QT_CONSTANT kNoTexture = 0xFFFFFFFFu;

// uv' = (dot(rowU, (u, v, 1)), dot(rowV, (u, v, 1)))
struct TextureData {
  vec3 rowU;
  vec3 rowV;
  uint index;  // into the bindless array, or kNoTexture
  uint uvSet;
};
QT_SHARED_SIZE(TextureData, 32);

// MaterialData::flags
QT_CONSTANT kMaterialMask = 1u;         // alpha < alphaCutoff: no surface
QT_CONSTANT kMaterialBlend = 2u;        // a hit counts with probability alpha
QT_CONSTANT kMaterialUnlit = 4u;        // base color is the outgoing radiance
QT_CONSTANT kMaterialThin = 8u;         // transmission without refraction (no volume)
QT_CONSTANT kMaterialEmissive = 16u;    // emissive factor is not zero
QT_CONSTANT kMaterialPane = 64u;        // thin, and smooth in some places: can transmit light without deflection
QT_CONSTANT kMaterialSolid = 128u;       // light enters a closed solid: a medium (quintet/media.glsl)
QT_CONSTANT kMaterialDoubleSided = 32u;  // informative only: every surface is rendered on both sides

// Bit kMaterialTextureShift + k of the flags is set if the k-th texture of MaterialData exists.
QT_CONSTANT kMaterialTextureShift = 8;
QT_CONSTANT kTextureBaseColor = 0;
QT_CONSTANT kTextureMetallicRoughness = 1;
QT_CONSTANT kTextureNormal = 2;
QT_CONSTANT kTextureEmissive = 3;
QT_CONSTANT kTextureTransmission = 4;
QT_CONSTANT kTextureSpecular = 5;
QT_CONSTANT kTextureSpecularColor = 6;
QT_CONSTANT kTextureClearcoat = 7;
QT_CONSTANT kTextureClearcoatRoughness = 8;
QT_CONSTANT kTextureClearcoatNormal = 9;
QT_CONSTANT kTextureSheenColor = 10;
QT_CONSTANT kTextureSheenRoughness = 11;
QT_CONSTANT kTextureDiffuseTransmission = 12;
QT_CONSTANT kTextureDiffuseTransmissionColor = 13;
QT_CONSTANT kTextureAnisotropy = 14;
QT_CONSTANT kTextureIridescence = 15;
QT_CONSTANT kTextureIridescenceThickness = 16;
QT_CONSTANT kTextureCount = 17;
QT_CONSTANT kMaterialTextureOffset = 180;  // byte offset of the first texture in MaterialData

struct MaterialData {
  vec4 baseColor;
  vec3 emissive;      // radiance
  float metallic;
  float roughness;    // perceptual
  float normalScale;
  float alphaCutoff;
  float ior;
  float transmission;
  float specular;
  vec3 specularColor;
  float clearcoat;
  float clearcoatRoughness;
  float clearcoatNormalScale;
  vec3 absorption;    // attenuation, 1/m: -ln(attenuationColor)/attenuationDistance; 0 for none
  uint flags;
  vec3 sheenColor;
  float sheenRoughness;
  vec3 diffuseTransmissionColor;
  float diffuseTransmission;
  float anisotropy;         // strength
  vec2 anisotropyDirection;  // cosine and sine of the rotation
  float iridescence;
  float iridescenceIor;
  float iridescenceThicknessMinimum;  // nanometers
  float iridescenceThicknessMaximum;  // nanometers
  float dispersion;          // 20 / Abbe number
  vec3 scatteringAlbedo;     // fraction of `absorption` that scatters instead; 0 for none
  float scatterAnisotropy;   // of the phase function, (-1,1)
  float dielectricPriority;  // of solids that overlap, the medium is that of the highest priority
  TextureData baseColorTexture;
  TextureData metallicRoughnessTexture;
  TextureData normalTexture;
  TextureData emissiveTexture;
  TextureData transmissionTexture;
  TextureData specularTexture;
  TextureData specularColorTexture;
  TextureData clearcoatTexture;
  TextureData clearcoatRoughnessTexture;
  TextureData clearcoatNormalTexture;
  TextureData sheenColorTexture;
  TextureData sheenRoughnessTexture;
  TextureData diffuseTransmissionTexture;
  TextureData diffuseTransmissionColorTexture;
  TextureData anisotropyTexture;
  TextureData iridescenceTexture;
  TextureData iridescenceThicknessTexture;
};
QT_SHARED_SIZE(MaterialData, kMaterialTextureOffset + kTextureCount * 32);

QT_SHARED_END

#endif
