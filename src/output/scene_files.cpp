// SPDX-License-Identifier: Apache-2.0
#include "output/scene_files.h"

#include <map>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"

namespace quintet::output {
namespace {

constexpr std::string_view kScene = "{scene}", kFolder = "{folder}";

std::string nameOf(const std::filesystem::path& scene) {
  if (scene == kStandardInput) return "stdin";
  std::filesystem::path name = scene.filename().stem();
  if (scene.extension() == ".toml" && name.extension() == ".scene") name = name.stem();
  return name.string();
}

}  // namespace

std::filesystem::path sceneFile(const std::filesystem::path& pattern, const std::filesystem::path& scene) {
  const std::string text = pattern.string();
  std::string file;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view rest = std::string_view(text).substr(at);
    if (rest.starts_with(kScene)) {
      file += nameOf(scene);
      at += kScene.size();
    } else if (rest.starts_with(kFolder)) {
      file += std::filesystem::absolute(scene).lexically_normal().parent_path().filename().string();
      at += kFolder.size();
    } else {
      file += text[at++];
    }
  }
  return file;
}

std::vector<std::filesystem::path> sceneFiles(const std::filesystem::path& pattern,
                                              std::span<const std::filesystem::path> scenes) {
  const std::filesystem::path used = pattern.empty() ? fmt::format("{}.png", kScene) : pattern.string();
  std::vector<std::filesystem::path> files;
  std::map<std::filesystem::path, std::filesystem::path> owners;
  for (const std::filesystem::path& scene : scenes) {
    files.push_back(sceneFile(used, scene));
    const auto [other, isNew] = owners.emplace(files.back().lexically_normal(), scene);
    if (isNew) continue;
    const bool hasName = used.string().find(kScene) != std::string::npos;
    throw UsageError(
        fmt::format("{} would be the file of {} and of {}; name the files with {} in the output, such as '{}'",
                    files.back().string(), other->second.string(), scene.string(), hasName ? kFolder : kScene,
                    hasName ? "{folder}_{scene}.png" : "{scene}.png"));
  }
  return files;
}

}  // namespace quintet::output
