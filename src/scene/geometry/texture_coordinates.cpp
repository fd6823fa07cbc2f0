// SPDX-License-Identifier: Apache-2.0
#include "scene/geometry/texture_coordinates.h"

#include <algorithm>
#include <map>
#include <utility>

#include "scene/model/material_textures.h"

namespace quintet::scene {

unsigned missingUvSets(const Geometry& geometry, const Material& material) {
  unsigned missing = 0;
  for (const MaterialTexture& texture : kMaterialTextures) {
    const TextureUse& use = material.*texture.use;
    if (texture.use == &Material::occlusionTexture || !use.used()) continue;
    if (geometry.uvs[static_cast<std::size_t>(use.uvSet)].empty()) missing |= 1u << use.uvSet;
  }
  return missing;
}

Material withoutUvSets(Material material, unsigned sets) {
  for (const MaterialTexture& texture : kMaterialTextures)
    if (TextureUse& use = material.*texture.use; use.used() && (sets >> use.uvSet & 1u)) use = {};
  return material;
}

std::vector<MaterialCopy> copyMaterialsWithoutUvs(Scene& scene) {
  std::map<std::pair<int, unsigned>, int> known;
  std::vector<MaterialCopy> copies;
  for (Mesh& mesh : scene.meshes)
    for (Geometry& geometry : mesh.geometries) {
      if (geometry.material == kNone) continue;
      const Material& material = scene.materials[static_cast<std::size_t>(geometry.material)];
      const unsigned missing = missingUvSets(geometry, material);
      if (missing == 0) continue;
      const auto [copy, isNew] =
          known.try_emplace({geometry.material, missing}, static_cast<int>(scene.materials.size()));
      if (isNew) {
        copies.push_back({geometry.material, copy->second});
        scene.materials.push_back(withoutUvSets(material, missing));
      }
      geometry.material = copy->second;
    }
  return copies;
}

void animateCopies(NodeAnimation& animation, const std::vector<MaterialCopy>& copies) {
  for (const MaterialCopy& copy : copies) {
    const auto animated = std::ranges::find(animation.materials, copy.from, &AnimatedMaterial::material);
    if (animated == animation.materials.end()) continue;
    AnimatedMaterial same = *animated;
    same.material = copy.copy;
    animation.materials.push_back(std::move(same));
  }
}

}  // namespace quintet::scene
