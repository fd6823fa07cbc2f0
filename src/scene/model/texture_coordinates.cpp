// SPDX-License-Identifier: Apache-2.0
#include "scene/model/texture_coordinates.h"

#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "scene/model/material_textures.h"

namespace quintet::scene {
namespace {

// Of kMaterialTextures, as in the C++ API.
constexpr std::array<const char*, kMaterialTextures.size()> kNames{"baseColorTexture",
                                                                   "metallicRoughnessTexture",
                                                                   "normalTexture",
                                                                   "emissiveTexture",
                                                                   "transmissionTexture",
                                                                   "specularTexture",
                                                                   "specularColorTexture",
                                                                   "clearcoatTexture",
                                                                   "clearcoatRoughnessTexture",
                                                                   "clearcoatNormalTexture",
                                                                   "sheenColorTexture",
                                                                   "sheenRoughnessTexture",
                                                                   "diffuseTransmissionTexture",
                                                                   "diffuseTransmissionColorTexture",
                                                                   "anisotropyTexture",
                                                                   "iridescenceTexture",
                                                                   "iridescenceThicknessTexture",
                                                                   "occlusionTexture"};

bool lacks(const Geometry& geometry, const TextureUse& use) {
  const auto set = static_cast<std::size_t>(use.uvSet);
  return use.used() && use.uvSet >= 0 && !geometry.positions.empty() &&
         (set >= geometry.uvs.size() || geometry.uvs[set].empty());
}

// `before`: what the material was; null if it is new.
void requireOf(const Geometry& geometry, const std::string& mesh, const Material& material, std::size_t index,
               const Material* before) {
  for (std::size_t i = 0; i < kMaterialTextures.size(); ++i) {
    const auto member = kMaterialTextures[i].use;
    const TextureUse& use = material.*member;
    if (!lacks(geometry, use)) continue;
    if (before && lacks(geometry, before->*member) && (before->*member).uvSet == use.uvSet) continue;
    const std::string shown =
        material.name.empty() ? fmt::format("material {}", index) : fmt::format("material '{}'", material.name);
    throw UsageError(fmt::format("{}: uv{} is missing, which {} of {} uses", mesh, use.uvSet, kNames[i], shown));
  }
}

}  // namespace

void requireCoordinates(const Mesh& mesh, const std::string& name, const Scene& scene) {
  for (const Geometry& geometry : mesh.geometries) {
    const auto material = static_cast<std::size_t>(geometry.material);
    if (geometry.material >= 0 && material < scene.materials.size())
      requireOf(geometry, name, scene.materials[material], material, nullptr);
  }
}

void requireCoordinates(const Scene& scene, std::size_t material, const Material& changed) {
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
    const Mesh& mesh = scene.meshes[i];
    for (const Geometry& geometry : mesh.geometries)
      if (geometry.material >= 0 && static_cast<std::size_t>(geometry.material) == material)
        requireOf(geometry,
                  mesh.name.empty() ? fmt::format("mesh {} of the scene", i) : fmt::format("mesh '{}'", mesh.name),
                  changed, material, &scene.materials[material]);
  }
}

}  // namespace quintet::scene
