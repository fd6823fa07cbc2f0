// SPDX-License-Identifier: Apache-2.0
#include "check/rules/across_stages/binding_names.h"

#include <algorithm>

#include "base/suggestion.h"

namespace quintet::check {
namespace {

using Names = std::vector<std::string>;

Names namesOf(const program::SceneFacts& scene, bool material) {
  Names names;
  for (const program::GeometryFacts& geometry : scene.geometries) {
    const std::string& name = material ? geometry.material : geometry.name;
    if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

const Names& bindingOf(const program::HitGroup& group, bool material) {
  return material ? group.material : group.primitives;
}

}  // namespace

std::vector<UnknownName> unknownNames(const program::Program& program, const program::SceneFacts& scene) {
  std::vector<UnknownName> result;
  for (std::size_t group = 0; group < program.hitGroups.size(); ++group) {
    for (const bool material : {false, true}) {
      const Names known = namesOf(scene, material);
      Names unbound = known;
      for (const program::HitGroup& other : program.hitGroups)
        for (const std::string& name : bindingOf(other, material)) std::erase(unbound, name);
      for (const std::string& name : bindingOf(program.hitGroups[group], material))
        if (std::ranges::find(known, name) == known.end())
          result.push_back({group, material, name, nearestName(name, unbound)});
    }
  }
  return result;
}

bool isMisplaced(const program::GeometryFacts& geometry, const std::vector<UnknownName>& names) {
  return std::ranges::any_of(names, [&](const UnknownName& unknown) {
    return !unknown.nearest.empty() && unknown.nearest == (unknown.material ? geometry.material : geometry.name);
  });
}

}  // namespace quintet::check
