// SPDX-License-Identifier: Apache-2.0
#include "job/scene_source.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "program/hit_group_binding.h"
#include "scene/toml/scene_toml.h"

namespace quintet::job {
namespace {

void checkReadable(const std::filesystem::path& file) {
  if (file == kStandardInput) return;
  if (::access(file.c_str(), R_OK) != 0)
    throw FileError(file, "cannot be read: " + std::generic_category().message(errno));
}

// True if a hit group serves such geometry, with an intersection shader for boxes and without one for triangles.
bool serves(const program::Program& program, program::GeometryKind kind) {
  if (program.hitGroups.empty()) return kind == program::GeometryKind::triangles;
  const program::HitGroup& group = program.hitGroups[program::hitGroupFor(program, {kind, false, {}, {}})];
  const bool intersects =
      std::ranges::any_of(group.shaders, [](const auto& entry) { return !entry.second.intersection.empty(); });
  return intersects == (kind != program::GeometryKind::triangles);
}

scene::DefaultSceneOptions defaultSceneOptions(const program::Program& program) {
  scene::DefaultSceneOptions options;
  options.boxes = serves(program, program::GeometryKind::custom);
  options.triangles = serves(program, program::GeometryKind::triangles) || !options.boxes;
  return options;
}

}  // namespace

bool isSceneFile(const std::filesystem::path& file) {
  return file.filename() != "program.toml" && scene::sceneFormat(file, {}) != scene::SceneFormat::none;
}

SceneSource chooseSceneSource(const std::filesystem::path& requested, const program::Program& program,
                              const scene::LoadOptions& options) {
  if (!requested.empty()) {
    checkReadable(requested);
    return {.file = requested,
            .options = options,
            .name = requested == kStandardInput ? "standard input" : requested.filename().string()};
  }
  if (!options.variant.empty())
    throw UsageError(fmt::format("no variant '{}': only glTF files have material variants", options.variant));
  if (options.animation && !options.animation->empty())
    throw UsageError(fmt::format("no animation '{}': only glTF files have named animations", *options.animation));
  if (!options.scene.empty())
    throw UsageError(fmt::format("no scene '{}': only glTF files have scenes", options.scene));
  if (!program.scene.empty())
    return {.options = options, .name = program.path(program.scene), .text = program.files.at(program.scene)};
  return {.name = "default scene", .builtIn = defaultSceneOptions(program)};
}

scene::LoadOptions loadOptions(const RenderRequest& request, bool accumulates) {
  scene::LoadOptions options = request.load;
  options.framesPerSecond = request.framesPerSecond;
  const FrameRequest& frames = request.frames;
  const bool asksForFrames = frames.first || frames.count || frames.seconds || request.shutter || request.editable;
  const bool plays = !request.animation.empty() || (asksForFrames && !accumulates);
  if (plays && request.animation != "none") options.animation = request.animation;
  return options;
}

scene::PendingScene beginLoading(const SceneSource& source) {
  if (source.loaded) return scene::PendingScene(scene::Scene(*source.loaded));
  if (!source.file.empty()) return scene::beginLoading(source.file, source.options);
  if (!source.text.empty()) return scene::PendingScene(scene::parseSceneToml(source.text, source.name, source.options));
  return scene::PendingScene(scene::defaultScene(source.builtIn));
}

scene::Scene loadScene(const SceneSource& source) { return beginLoading(source).finish(); }

std::vector<std::filesystem::path> sourceFiles(const SceneSource& source) {
  const std::filesystem::path file = source.text.empty() ? source.file : std::filesystem::path(source.name);
  std::error_code ignored;
  if (file.empty() || !std::filesystem::exists(file, ignored)) return {};
  return {file};
}

}  // namespace quintet::job
