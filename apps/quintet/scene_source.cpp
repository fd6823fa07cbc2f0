#include "scene_source.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/error.h"
#include "render/program_scene.h"
#include "scene/load.h"
#include "scene/scene_toml.h"

namespace quintet::app {
namespace {

void checkReadable(const std::filesystem::path& file) {
  if (::access(file.c_str(), R_OK) != 0)
    throw FileError(file, "cannot be read: " + std::generic_category().message(errno));
}

}  // namespace

SceneSource chooseScene(const std::filesystem::path& asked, const program::Program& program) {
  if (!asked.empty()) {
    checkReadable(asked);
    return {asked, asked.filename().string(), {}, {}};
  }
  if (!program.scene.empty()) return {{}, program.path(program.scene), program.files.at(program.scene), {}};
  return {{}, "default scene", {}, render::defaultSceneOptions(program)};
}

scene::Scene loadScene(const SceneSource& source, const scene::Described& described) {
  if (!source.file.empty()) return scene::loadScene(source.file, described);
  scene::Scene scene =
      source.text.empty() ? scene::defaultScene(source.builtIn) : scene::parseSceneToml(source.text, source.name);
  if (described) described(scene);
  return scene;
}

std::vector<std::filesystem::path> sceneFiles(const SceneSource& source) {
  const std::filesystem::path file = source.text.empty() ? source.file : std::filesystem::path(source.name);
  std::error_code ignored;
  if (file.empty() || !std::filesystem::exists(file, ignored)) return {};
  return {file};
}

}  // namespace quintet::app
