// SPDX-License-Identifier: Apache-2.0
#include "program/hit_checks.h"

namespace quintet::program {

Program withHitChecks(Program program) {
  for (HitGroup& group : program.hitGroups) {
    for (const RayType& ray : program.rays) {
      HitShaders& shaders = group.shaders[ray.name];
      if (shaders.closestHit.empty()) shaders.closestHit = kHitCheckStage;
    }
  }
  return program;
}

}  // namespace quintet::program
