// SPDX-License-Identifier: Apache-2.0
// The shader stages with their names and file extensions.
#ifndef QUINTET_SHADER_STAGE_H
#define QUINTET_SHADER_STAGE_H

#include <filesystem>
#include <optional>
#include <string_view>

namespace quintet::shader {

enum class Stage { rayGeneration, intersection, anyHit, closestHit, miss, callable, compute, vertex, fragment };

std::string_view stageName(Stage);       // "ray generation"
std::string_view stageExtension(Stage);  // ".rgen"

// Returns the stage of a file by its extension (.rgen .rint .rahit .rchit .rmiss .rcall .comp .vert .frag; lower case).
std::optional<Stage> stageOfFile(const std::filesystem::path& file);

}  // namespace quintet::shader
#endif
