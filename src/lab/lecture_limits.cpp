// SPDX-License-Identifier: Apache-2.0
#include "lab/lecture_limits.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "program/lecture/lecture.h"

namespace quintet::lab {
namespace {

template <class Items>
std::string namesOf(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items) names.push_back(item.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

bool usesLibraryStage(const program::Program& program) {
  const auto isLibrary = [](const std::string& file) { return !file.empty() && program::isLibraryStage(file); };
  const auto ofGroup = [&](const program::HitGroup& group) {
    return std::ranges::any_of(group.shaders, [&](const auto& shaders) {
      return isLibrary(shaders.second.closestHit) || isLibrary(shaders.second.anyHit) ||
             isLibrary(shaders.second.intersection);
    });
  };
  return std::ranges::any_of(program.hitGroups, ofGroup) ||
         std::ranges::any_of(program.rays, [&](const program::RayType& ray) { return isLibrary(ray.miss); });
}

}  // namespace

std::vector<std::string> lectureObstacles(const program::Program& program) {
  if (program.descriptionFile.ends_with(program::kLectureExtension)) return {};
  std::vector<std::string> obstacles;
  if (program.rays.size() > 1) obstacles.push_back("it has the ray types " + namesOf(program.rays));
  if (program.hitGroups.size() > 1) obstacles.push_back("it has the hit groups " + namesOf(program.hitGroups));
  if (!program.record.empty()) obstacles.push_back("its shader records have the fields " + namesOf(program.record));
  if (program.outputs.size() > 1) obstacles.push_back("it has the outputs " + namesOf(program.outputs));
  if (usesLibraryStage(program)) obstacles.emplace_back("it uses shaders of the library");
  if (program.accumulation == program::Accumulation::film)
    obstacles.emplace_back("Quintet averages its samples, and a lecture file averages its frames itself");
  return obstacles;
}

}  // namespace quintet::lab
