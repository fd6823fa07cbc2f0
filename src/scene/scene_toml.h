// Scenes written by hand: *.scene.toml (docs/scenes.md). glTF files with transforms, materials, triangle shapes,
// analytic solids and trees of them, custom boxes, instances, lights, cameras, environment.
#ifndef QUINTET_SCENE_SCENE_TOML_H
#define QUINTET_SCENE_SCENE_TOML_H

#include <filesystem>
#include <string_view>

#include "scene/scene.h"

namespace quintet::scene {

struct SceneTomlOptions {
  std::size_t memoryLimit = 0;  // bytes that the scene may ask for; 0: the machine's memory
};

// Throws FileError "scene.toml: line 12: what", also for the files that it names; MemoryError.
Scene loadSceneToml(const std::filesystem::path& file);

// The same from text; `file` is its name in messages, and the folder that paths in it are relative to.
Scene parseSceneToml(std::string_view text, const std::filesystem::path& file, const SceneTomlOptions& options = {});

}  // namespace quintet::scene
#endif
