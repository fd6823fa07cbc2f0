// SPDX-License-Identifier: Apache-2.0
// Loads a scene file of any supported format: glTF (.gltf, .glb) or a scene file in TOML.
#ifndef QUINTET_SCENE_LOAD_H
#define QUINTET_SCENE_LOAD_H

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "scene/load_options.h"
#include "scene/model/scene.h"
#include "scene/pending_scene.h"

namespace quintet::scene {

enum class SceneFormat { none, gltf, toml };

// The format by the extension of the name (.gltf, .glb, .toml), else by the content: GLB's magic number, an opening
// brace of JSON, or a bracket or comment of TOML at the beginning.
SceneFormat sceneFormat(const std::filesystem::path& file, std::span<const std::byte> content);

// Reads the file except for its image data; a TOML scene is read completely. Throws FileError with the location in the
// file ("/accessors/3/bufferView", "line 3"), UsageError if the scene, the variant or the animation does not exist,
// MemoryError. finish() throws as well, for images.
PendingScene beginLoading(const std::filesystem::path& file, const LoadOptions& options = {});

// Both steps.
Scene loadScene(const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace quintet::scene
#endif
