// SPDX-License-Identifier: Apache-2.0
// Values that several commands accept, for completions.
#ifndef QUINTET_CLI_CANDIDATES_H
#define QUINTET_CLI_CANDIDATES_H

#include <string>
#include <vector>

#include "cli/option_table.h"
#include "program/load.h"

namespace quintet::cli {

inline const std::vector<std::string> kSceneExtensions{"gltf", "glb", "scene.toml"};

// Built-in programs, files and folders.
inline Candidates programCandidates() {
  return {.names = program::builtInPrograms(), .extensions = {"rt.glsl"}, .folders = true};
}

}  // namespace quintet::cli
#endif
