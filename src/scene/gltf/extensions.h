// SPDX-License-Identifier: Apache-2.0
// The glTF extensions that Quintet supports, and typed access to their JSON values.
#ifndef QUINTET_SCENE_GLTF_EXTENSIONS_H
#define QUINTET_SCENE_GLTF_EXTENSIONS_H

#include <tiny_gltf.h>

#include <filesystem>
#include <string>
#include <vector>

#include "scene/model/scene.h"

namespace quintet::scene {

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";
inline constexpr const char* kMeshopt = "KHR_meshopt_compression";
inline constexpr const char* kOldMeshopt = "EXT_meshopt_compression";
inline constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
inline constexpr const char* kPunctualLights = "KHR_lights_punctual";
inline constexpr const char* kTextureTransform = "KHR_texture_transform";
inline constexpr const char* kTextureWebp = "EXT_texture_webp";
inline constexpr const char* kTextureBasisu = "KHR_texture_basisu";
inline constexpr const char* kVariants = "KHR_materials_variants";

inline constexpr const char* kImageBasedLights = "EXT_lights_image_based";
inline constexpr const char* kVisibility = "KHR_node_visibility";
inline constexpr const char* kAnimationPointer = "KHR_animation_pointer";
inline constexpr const char* kXmp = "KHR_xmp_json_ld";
inline constexpr const char* kQuantization = "KHR_mesh_quantization";

bool isSupportedExtension(const std::string& name);
// Whether the extension contains only metadata, which cannot change the image.
bool hasNoEffect(const std::string& name);

// Throws FileError for the first entry of extensionsRequired that is not supported.
void checkRequiredExtensions(const std::filesystem::path& file, const std::vector<std::string>& required);
// Fills the report's lists from extensionsUsed.
void reportExtensions(const std::vector<std::string>& used, Report&);

// The value of an extension in a glTF object's extension map, or null.
const tinygltf::Value* findExtension(const tinygltf::ExtensionMap&, const std::string& name);

// Members of an extension's object. schema.cpp has checked their types.
double numberOf(const tinygltf::Value& object, const std::string& key, double fallback);
int indexOf(const tinygltf::Value& object, const std::string& key, int fallback = kNone);
std::string stringOf(const tinygltf::Value& object, const std::string& key, const std::string& fallback);
vec2 vec2Of(const tinygltf::Value& object, const std::string& key, vec2 fallback);
vec3 vec3Of(const tinygltf::Value& object, const std::string& key, vec3 fallback);
vec4 vec4Of(const tinygltf::Value& object, const std::string& key, vec4 fallback);

}  // namespace quintet::scene
#endif
