// SPDX-License-Identifier: Apache-2.0
// Names of the files that a render of several scenes writes: one for each scene.
#ifndef QUINTET_OUTPUT_SCENE_FILES_H
#define QUINTET_OUTPUT_SCENE_FILES_H

#include <filesystem>
#include <span>
#include <vector>

namespace quintet::output {

// The pattern with the name of the scene file, without its extension, for "{scene}", and with the name of the folder that
// contains it for "{folder}": "out/{scene}.png" becomes "out/fox.png" for models/fox.glb and models/fox.scene.toml.
std::filesystem::path sceneFile(const std::filesystem::path& pattern, const std::filesystem::path& scene);

// The files of all scenes, in their order. An empty pattern means "{scene}.png". Throws UsageError if two scenes would have the
// same file.
std::vector<std::filesystem::path> sceneFiles(const std::filesystem::path& pattern,
                                              std::span<const std::filesystem::path> scenes);

}  // namespace quintet::output
#endif
