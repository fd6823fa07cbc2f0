// SPDX-License-Identifier: Apache-2.0
// Q903: intersection shaders that hit groups with different any-hit shaders share, on drivers that would run the
// any-hit shader of the first group for all of them.
#include <fmt/format.h>

#include <map>

#include "check/rules/rules.h"

namespace quintet::check {

void checkSharedIntersections(const ProgramInput& input, Report& report) {
  struct Use {
    const program::HitGroup* group;
    const program::HitShaders* shaders;
  };
  std::map<std::string, Use> firstUses;
  for (const program::HitGroup& group : input.program.hitGroups) {
    for (const auto& [ray, shaders] : group.shaders) {
      if (shaders.intersection.empty() || shaders.anyHit.empty() || program::isLibraryStage(shaders.intersection))
        continue;
      const auto [first, isNew] = firstUses.try_emplace(shaders.intersection, Use{&group, &shaders});
      if (isNew || first->second.shaders->anyHit == shaders.anyHit) continue;
      report.add(
          "Q903", input.graph.descriptionLocation(shaders.line > 0 ? shaders.line : group.line),
          fmt::format("intersection shader '{}' is used with any-hit shader '{}' here and with '{}' in hit "
                      "group '{}'; on this device each gets its own copy",
                      shaders.intersection, shaders.anyHit, first->second.shaders->anyHit, first->second.group->name));
    }
  }
}

}  // namespace quintet::check
