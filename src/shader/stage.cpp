// SPDX-License-Identifier: Apache-2.0
#include "shader/stage.h"

#include <array>
#include <string>

namespace quintet::shader {
namespace {

struct StageNames {
  Stage stage;
  std::string_view name;
  std::string_view extension;
};

constexpr std::array kStages{
    StageNames{Stage::rayGeneration, "ray generation", ".rgen"},
    StageNames{Stage::intersection, "intersection", ".rint"},
    StageNames{Stage::anyHit, "any-hit", ".rahit"},
    StageNames{Stage::closestHit, "closest-hit", ".rchit"},
    StageNames{Stage::miss, "miss", ".rmiss"},
    StageNames{Stage::callable, "callable", ".rcall"},
    StageNames{Stage::compute, "compute", ".comp"},
    StageNames{Stage::vertex, "vertex", ".vert"},
    StageNames{Stage::fragment, "fragment", ".frag"},
};

constexpr const StageNames& namesOf(Stage stage) { return kStages[static_cast<std::size_t>(stage)]; }

}  // namespace

std::string_view stageName(Stage stage) { return namesOf(stage).name; }
std::string_view stageExtension(Stage stage) { return namesOf(stage).extension; }

std::optional<Stage> stageOfFile(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  for (const StageNames& s : kStages)
    if (s.extension == extension) return s.stage;
  return {};
}

}  // namespace quintet::shader
