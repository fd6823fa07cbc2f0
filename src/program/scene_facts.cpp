#include "program/scene_facts.h"

#include "program/program.h"

namespace quintet::program {

SceneFacts factsFor(const Program& program, SceneFacts facts) {
  if (!program.anyHitForAll) return facts;
  for (InstanceFacts& instance : facts.instances) instance.forceNoOpaque = !instance.forceOpaque;
  return facts;
}

}  // namespace quintet::program
