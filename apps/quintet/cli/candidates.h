// SPDX-License-Identifier: Apache-2.0
// Values that several commands accept, for completions.
#ifndef QUINTET_CLI_CANDIDATES_H
#define QUINTET_CLI_CANDIDATES_H

#include <string>
#include <string_view>
#include <vector>

#include "cli/option_table.h"
#include "program/load.h"

namespace quintet::cli {

inline const std::vector<std::string> kSceneExtensions{"gltf", "glb", "scene.toml"};

// Built-in programs, files and folders.
inline Candidates programCandidates() {
  return {.names = program::builtInPrograms(), .extensions = {"rt.glsl"}, .folders = true};
}

inline Candidates programOrSceneCandidates() {
  Candidates candidates = programCandidates();
  candidates.extensions.insert(candidates.extensions.end(), kSceneExtensions.begin(), kSceneExtensions.end());
  return candidates;
}

// Of --device.
inline constexpr std::string_view kDeviceHelp = "Index, or part of the name, driver name or kind";

inline std::vector<std::string> deviceNames(std::vector<std::string> more = {}) {
  more.insert(more.end(), {"0", "cpu", "gpu", "lavapipe"});
  return more;
}

}  // namespace quintet::cli
#endif
