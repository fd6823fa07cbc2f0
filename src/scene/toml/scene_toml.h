// SPDX-License-Identifier: Apache-2.0
// Scene files (*.scene.toml, docs/scenes.md): glTF files, materials, triangle shapes, analytic solids, CSG trees,
// custom boxes, instances, lights, cameras and an environment.
#ifndef QUINTET_SCENE_TOML_SCENE_TOML_H
#define QUINTET_SCENE_TOML_SCENE_TOML_H

#include <filesystem>
#include <string_view>

#include "scene/load_options.h"
#include "scene/model/scene.h"

namespace quintet::scene {

// Throws FileError "scene.toml: line 12: problem", FileError of a file that the scene names, MemoryError. UsageError for
// options.scene and options.variant, which are keys of [[file]].
Scene loadSceneToml(const std::filesystem::path& file, const LoadOptions& options = {});

// Reads a scene from text. `file` is its name in messages; paths are relative to the folder of `file`.
Scene parseSceneToml(std::string_view text, const std::filesystem::path& file, const LoadOptions& options = {});

}  // namespace quintet::scene
#endif
