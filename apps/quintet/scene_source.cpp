#include "scene_source.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "base/error.h"
#include "scene/default_scene.h"
#include "scene/load.h"

namespace quintet::app {
namespace {

void checkReadable(const std::filesystem::path& file) {
  if (::access(file.c_str(), R_OK) != 0)
    throw FileError(file, "cannot be read: " + std::generic_category().message(errno));
}

bool hasIntersection(const program::HitGroup& group) {
  return std::ranges::any_of(group.shaders, [](const auto& entry) { return !entry.second.intersection.empty(); });
}

}  // namespace

SceneSource chooseScene(const std::filesystem::path& asked, const program::Program& program) {
  if (!asked.empty()) {
    checkReadable(asked);
    return {asked, asked.filename().string(), {}};
  }
  SceneSource source{{}, "default scene", {}};
  source.builtIn.boxes = std::ranges::any_of(program.hitGroups, hasIntersection);
  source.builtIn.triangles = !source.builtIn.boxes || !std::ranges::all_of(program.hitGroups, hasIntersection);
  return source;
}

scene::Scene loadScene(const SceneSource& source) {
  return source.file.empty() ? scene::defaultScene(source.builtIn) : scene::loadScene(source.file);
}

std::vector<std::filesystem::path> sceneFiles(const SceneSource& source) {
  if (source.file.empty()) return {};
  return {source.file};
}

}  // namespace quintet::app
