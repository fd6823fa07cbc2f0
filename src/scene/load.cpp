#include "scene/load.h"

#include <algorithm>
#include <cctype>
#include <string_view>

#include "base/file.h"
#include "scene/gltf.h"
#include "scene/scene_toml.h"

namespace quintet::scene {

SceneFormat sceneFormat(const std::filesystem::path& file, std::span<const std::byte> content) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".gltf" || extension == ".glb") return SceneFormat::gltf;
  if (extension == ".toml") return SceneFormat::toml;
  const std::string_view text(reinterpret_cast<const char*>(content.data()), content.size());
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (text.starts_with("glTF")) return SceneFormat::gltf;
  if (first == std::string_view::npos) return SceneFormat::none;
  if (text[first] == '{') return SceneFormat::gltf;
  return text[first] == '[' || text[first] == '#' ? SceneFormat::toml : SceneFormat::none;
}

Scene loadScene(const std::filesystem::path& file, const Described& described) {
  // Only a name that says nothing needs a look inside.
  SceneFormat format = sceneFormat(file, {});
  if (format == SceneFormat::none) format = sceneFormat(file, readFile(file));
  if (format != SceneFormat::toml)
    return loadGltf(file, {.described = described});  // also says what is wrong with a file of no format
  Scene scene = loadSceneToml(file);
  if (described) described(scene);
  return scene;
}

}  // namespace quintet::scene
