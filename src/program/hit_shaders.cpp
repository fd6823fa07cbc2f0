// SPDX-License-Identifier: Apache-2.0
#include "program/hit_shaders.h"

namespace quintet::program {

const char* hitStage(Instrumentation instrumentation) {
  return instrumentation == Instrumentation::explain ? "<quintet/stages/explained_hit.rchit>"
                                                     : "<quintet/stages/self_hit.rchit>";
}

bool isHitStage(const std::string& file) {
  return file == hitStage(Instrumentation::checks) || file == hitStage(Instrumentation::explain);
}

Program withHitShaders(Program program, Instrumentation instrumentation) {
  program.mergesInstances = false;  // these shaders read gl_InstanceCustomIndexEXT
  for (HitGroup& group : program.hitGroups) {
    for (const RayType& ray : program.rays) {
      HitShaders& shaders = group.shaders[ray.name];
      if (shaders.closestHit.empty()) shaders.closestHit = hitStage(instrumentation);
    }
  }
  return program;
}

}  // namespace quintet::program
