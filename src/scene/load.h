// Any scene file, told apart by its name, else by its content.
#ifndef QUINTET_SCENE_LOAD_H
#define QUINTET_SCENE_LOAD_H

#include <cstddef>
#include <filesystem>
#include <span>

#include "scene/gltf.h"

namespace quintet::scene {

enum class SceneFormat { none, gltf, toml };

// .gltf, .glb and .toml by the name; else a GLB's magic number, JSON's brace, or TOML's bracket or comment at
// the beginning.
SceneFormat sceneFormat(const std::filesystem::path& file, std::span<const std::byte> content);

// Throws FileError with the place in the file ("/accessors/3/bufferView", "line 3"), MemoryError.
Scene loadScene(const std::filesystem::path& file, const Described& described = {});

}  // namespace quintet::scene
#endif
