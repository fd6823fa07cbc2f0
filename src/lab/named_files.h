// SPDX-License-Identifier: Apache-2.0
// Which other files a program or a scene names: by #include, as a scene or an image, or as a part of a scene.
#ifndef QUINTET_LAB_NAMED_FILES_H
#define QUINTET_LAB_NAMED_FILES_H

#include <filesystem>
#include <string>
#include <vector>

namespace quintet::lab {

inline constexpr std::size_t kMaxNamedFiles = 1000;

// `file`, a name in the folder, and the existing files of the folder that it names, and that these name: in a lecture file, a scene
// file (.scene.toml), or a glTF file. Files that cannot be read name no others.
std::vector<std::string> namedFiles(const std::filesystem::path& folder, const std::string& file);

}  // namespace quintet::lab
#endif
