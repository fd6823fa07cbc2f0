// SPDX-License-Identifier: Apache-2.0
#include "scene/load.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/file.h"
#include "base/memory_budget.h"
#include "base/text.h"
#include "scene/gltf/gltf.h"
#include "scene/toml/scene_toml.h"

namespace quintet::scene {

SceneFormat sceneFormat(const std::filesystem::path& file, std::span<const std::byte> content) {
  const std::string extension = lowerCase(file.extension().string());
  if (extension == ".gltf" || extension == ".glb") return SceneFormat::gltf;
  if (extension == ".toml") return SceneFormat::toml;
  const std::string_view text(reinterpret_cast<const char*>(content.data()), content.size());
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (text.starts_with("glTF")) return SceneFormat::gltf;
  if (first == std::string_view::npos) return SceneFormat::none;
  if (text[first] == '{') return SceneFormat::gltf;
  return text[first] == '[' || text[first] == '#' ? SceneFormat::toml : SceneFormat::none;
}

PendingScene beginLoading(const std::filesystem::path& file, const LoadOptions& options) {
  // The content is read only if the name does not determine the format.
  SceneFormat format = sceneFormat(file, {});
  if (format == SceneFormat::none) {
    MemoryBudget budget(file, options.maxMemory);
    format = sceneFormat(file, readFile(file, budget));
  }
  if (format == SceneFormat::toml && options.animation && !options.animation->empty())
    throw UsageError(
        fmt::format("{}: no animation '{}': only glTF files have named animations; a scene file has keyframes",
                    file.string(), *options.animation));
  if (format == SceneFormat::toml) return PendingScene(loadSceneToml(file, options));
  return beginLoadingGltf(file, options);  // also reports the problem of a file without a known format
}

Scene loadScene(const std::filesystem::path& file, const LoadOptions& options) {
  return beginLoading(file, options).finish();
}

}  // namespace quintet::scene
