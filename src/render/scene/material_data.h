// SPDX-License-Identifier: Apache-2.0
// scene::Material to the device's form.
#ifndef QUINTET_RENDER_SCENE_MATERIAL_DATA_H
#define QUINTET_RENDER_SCENE_MATERIAL_DATA_H

#include <functional>

#include "quintet/shared/material.h"
#include "scene/model/scene.h"

namespace quintet::render {

// Gives the bindless index of a texture of the scene, decoded as sRGB color or as linear data.
using TextureIndex = std::function<std::uint32_t(int texture, bool sRgb)>;

shared::MaterialData makeMaterial(const scene::Material& material, const TextureIndex& textureIndex);

}  // namespace quintet::render
#endif
