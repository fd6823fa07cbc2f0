// scene::Material to the device's form.
#ifndef QUINTET_RENDER_MATERIAL_DATA_H
#define QUINTET_RENDER_MATERIAL_DATA_H

#include <functional>

#include "quintet/shared/material.h"
#include "scene/scene.h"

namespace quintet::render {

// Gives the bindless index of a texture of the scene, decoded as sRGB colour or as linear data.
using TextureIndex = std::function<std::uint32_t(int texture, bool sRgb)>;

shared::MaterialData makeMaterial(const scene::Material& material, const TextureIndex& textureIndex);

// True if some of the surface may be absent: mask or blend, with an alpha that can be below 1.
bool needsAlphaTest(const scene::Scene& scene, const scene::Geometry& geometry);
bool needsAlphaTest(const scene::Scene& scene, const scene::PrimitiveSet& set);

// True if light may go straight through the surface: a thin wall that is smooth, at least in places. Shadow rays pass
// it and lose what it does not let through.
bool isPane(const scene::Material& material);
bool isPane(const scene::Scene& scene, const scene::Geometry& geometry);
bool isPane(const scene::Scene& scene, const scene::PrimitiveSet& set);

// True if a shadow ray may keep part of its light here: panes and alpha blend.
bool tintsShadows(const scene::Scene& scene, const scene::Geometry& geometry);
bool tintsShadows(const scene::Scene& scene, const scene::PrimitiveSet& set);

}  // namespace quintet::render
#endif
