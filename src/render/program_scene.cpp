#include "render/program_scene.h"

#include <algorithm>

#include "scene/scene_toml.h"

namespace quintet::render {
namespace {

bool hasIntersection(const program::HitGroup& group) {
  return std::ranges::any_of(group.shaders, [](const auto& entry) { return !entry.second.intersection.empty(); });
}

}  // namespace

scene::DefaultSceneOptions defaultSceneOptions(const program::Program& program) {
  scene::DefaultSceneOptions options;
  options.boxes = std::ranges::any_of(program.hitGroups, hasIntersection);
  options.triangles = !options.boxes || !std::ranges::all_of(program.hitGroups, hasIntersection);
  return options;
}

scene::Scene programScene(const program::Program& program) {
  if (!program.scene.empty()) return scene::parseSceneToml(program.files.at(program.scene), program.path(program.scene));
  return scene::defaultScene(defaultSceneOptions(program));
}

}  // namespace quintet::render
