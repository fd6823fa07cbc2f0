// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf/extensions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>
#include <string_view>

#include "base/error.h"
#include "base/text.h"

namespace quintet::scene {
namespace {

// In the order of docs/gltf.md.
constexpr auto kSupported = std::to_array<std::string_view>({
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_materials_unlit",
    "KHR_materials_specular",
    "KHR_materials_clearcoat",
    "KHR_materials_sheen",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_anisotropy",
    "KHR_materials_iridescence",
    "KHR_materials_dispersion",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_variants",
    "KHR_lights_punctual",
    "EXT_lights_image_based",
    "KHR_node_visibility",
    "KHR_animation_pointer",
    "KHR_xmp_json_ld",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "EXT_texture_webp",
    "KHR_texture_basisu",
    "EXT_mesh_gpu_instancing",
    "KHR_draco_mesh_compression",
    "KHR_meshopt_compression",
    "EXT_meshopt_compression",
});

constexpr auto kWithoutEffect = std::to_array<std::string_view>({"KHR_xmp"});

bool contains(std::span<const std::string_view> list, const std::string& name) {
  return std::ranges::find(list, name) != list.end();
}

template <class Vec>
Vec vectorOf(const tinygltf::Value& object, const std::string& key, Vec fallback) {
  if (!object.Has(key)) return fallback;
  const tinygltf::Value& array = object.Get(key);
  for (std::size_t i = 0; i < fallback.length(); ++i)
    fallback[i] = static_cast<float>(array.Get(static_cast<int>(i)).GetNumberAsDouble());
  return fallback;
}

}  // namespace

bool isSupportedExtension(const std::string& name) { return contains(kSupported, name); }
bool hasNoEffect(const std::string& name) { return contains(kWithoutEffect, name); }

void checkRequiredExtensions(const std::filesystem::path& file, const std::vector<std::string>& required) {
  for (std::size_t i = 0; i < required.size(); ++i)
    if (!isSupportedExtension(required[i]) && !hasNoEffect(required[i]))
      throw FileError(file, fmt::format("/extensionsRequired/{}", i),
                      printable(fmt::format("{} is not supported", required[i].substr(0, 80))));
}

void reportExtensions(const std::vector<std::string>& used, Report& report) {
  for (const std::string& name : used)
    (isSupportedExtension(name) ? report.extensionsUsed : report.extensionsIgnored).push_back(name);
}

const tinygltf::Value* findExtension(const tinygltf::ExtensionMap& extensions, const std::string& name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

double numberOf(const tinygltf::Value& object, const std::string& key, double fallback) {
  return object.Has(key) ? object.Get(key).GetNumberAsDouble() : fallback;
}
int indexOf(const tinygltf::Value& object, const std::string& key, int fallback) {
  return object.Has(key) ? object.Get(key).GetNumberAsInt() : fallback;
}
std::string stringOf(const tinygltf::Value& object, const std::string& key, const std::string& fallback) {
  return object.Has(key) ? object.Get(key).Get<std::string>() : fallback;
}
vec2 vec2Of(const tinygltf::Value& object, const std::string& key, vec2 fallback) {
  return vectorOf(object, key, fallback);
}
vec3 vec3Of(const tinygltf::Value& object, const std::string& key, vec3 fallback) {
  return vectorOf(object, key, fallback);
}
vec4 vec4Of(const tinygltf::Value& object, const std::string& key, vec4 fallback) {
  return vectorOf(object, key, fallback);
}

}  // namespace quintet::scene
