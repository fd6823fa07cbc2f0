// SPDX-License-Identifier: Apache-2.0
// The textures of a material, for code that treats all of them alike.
#ifndef QUINTET_SCENE_MODEL_MATERIAL_TEXTURES_H
#define QUINTET_SCENE_MODEL_MATERIAL_TEXTURES_H

#include <array>

#include "scene/model/scene.h"

namespace quintet::scene {

struct MaterialTexture {
  TextureUse Material::*use;
  bool sRgb;  // 8-bit values are sRGB-encoded colors
};

// In the order of kTexture… (quintet/shared/material.h). The last one is the occlusion texture, which no shader reads.
inline constexpr std::array kMaterialTextures{
    MaterialTexture{&Material::baseColorTexture, true},
    MaterialTexture{&Material::metallicRoughnessTexture, false},
    MaterialTexture{&Material::normalTexture, false},
    MaterialTexture{&Material::emissiveTexture, true},
    MaterialTexture{&Material::transmissionTexture, false},
    MaterialTexture{&Material::specularTexture, false},
    MaterialTexture{&Material::specularColorTexture, true},
    MaterialTexture{&Material::clearcoatTexture, false},
    MaterialTexture{&Material::clearcoatRoughnessTexture, false},
    MaterialTexture{&Material::clearcoatNormalTexture, false},
    MaterialTexture{&Material::sheenColorTexture, true},
    MaterialTexture{&Material::sheenRoughnessTexture, false},
    MaterialTexture{&Material::diffuseTransmissionTexture, false},
    MaterialTexture{&Material::diffuseTransmissionColorTexture, true},
    MaterialTexture{&Material::anisotropyTexture, false},
    MaterialTexture{&Material::iridescenceTexture, false},
    MaterialTexture{&Material::iridescenceThicknessTexture, false},
    MaterialTexture{&Material::occlusionTexture, false},
};

}  // namespace quintet::scene
#endif
