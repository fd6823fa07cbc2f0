#include "render/program_scene.h"

#include <algorithm>

#include "program/link.h"
#include "scene/scene_toml.h"

namespace quintet::render {
namespace {

// Is there a hit group that serves such geometry, with an intersection shader for boxes and none for triangles?
bool serves(const program::Program& program, program::GeometryKind kind) {
  if (program.hitGroups.empty()) return kind == program::GeometryKind::triangles;
  const program::HitGroup& group = program.hitGroups[program::hitGroupFor(program, {kind, false, {}, {}})];
  const bool intersects =
      std::ranges::any_of(group.shaders, [](const auto& entry) { return !entry.second.intersection.empty(); });
  return intersects == (kind != program::GeometryKind::triangles);
}

}  // namespace

scene::DefaultSceneOptions defaultSceneOptions(const program::Program& program) {
  scene::DefaultSceneOptions options;
  options.boxes = serves(program, program::GeometryKind::custom);
  options.triangles = serves(program, program::GeometryKind::triangles) || !options.boxes;
  return options;
}

scene::Scene programScene(const program::Program& program) {
  if (!program.scene.empty())
    return scene::parseSceneToml(program.files.at(program.scene), program.path(program.scene));
  return scene::defaultScene(defaultSceneOptions(program));
}

}  // namespace quintet::render
