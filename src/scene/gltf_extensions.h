// Which glTF extensions Quintet understands, and reading their values.
#ifndef QUINTET_SCENE_GLTF_EXTENSIONS_H
#define QUINTET_SCENE_GLTF_EXTENSIONS_H

#include <string>
#include <vector>

#include "scene/gltf_document.h"

namespace quintet::scene {

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";
inline constexpr const char* kMeshopt = "EXT_meshopt_compression";
inline constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
inline constexpr const char* kPunctualLights = "KHR_lights_punctual";
inline constexpr const char* kTextureTransform = "KHR_texture_transform";
inline constexpr const char* kTextureWebp = "EXT_texture_webp";

// Throws FileError for the first one in extensionsRequired that is unknown.
void checkRequiredExtensions(const Document&, const std::vector<std::string>& required);
// Fills the report's lists from extensionsUsed.
void reportExtensions(const Document&, Report&);

// The extension's object of a glTF object's extension map, or null.
const tinygltf::Value* findExtension(const tinygltf::ExtensionMap&, const std::string& name);

// Members of an extension object; gltf_schema has checked their types.
double numberOf(const tinygltf::Value& object, const std::string& key, double fallback);
int indexOf(const tinygltf::Value& object, const std::string& key, int fallback = kNone);
std::string stringOf(const tinygltf::Value& object, const std::string& key, const std::string& fallback);
vec2 vec2Of(const tinygltf::Value& object, const std::string& key, vec2 fallback);
vec3 vec3Of(const tinygltf::Value& object, const std::string& key, vec3 fallback);

}  // namespace quintet::scene
#endif
