// SPDX-License-Identifier: Apache-2.0
// Q719: gl_RayTmaxEXT of a miss shader, which is the tmax of the trace, is used as the distance of a hit.
//
// To store it as the distance "nothing nearer than tmax" is correct. It is reported if the receiver can only recognize a
// miss by a negative distance, if it continues the path at that distance without a condition, or if the miss shader
// itself traces a ray from there.
#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "check/rules/rules.h"
#include "check/rules/user_location.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;

bool isTmax(const spirv::Module& module, Id value) {
  return spirv::loadsBuiltIn(module, value, spv::BuiltIn::RayTmaxKHR);
}

// True for origin + t * direction of the incoming ray.
bool isEndOfRay(const spirv::Module& module, Id value) {
  const spirv::Instruction* sum = module.definition(value);
  if (!sum || sum->op != Op::OpFAdd) return false;
  for (const std::size_t k : {0u, 1u}) {
    const spirv::Instruction* step = module.definition(sum->at(k));
    if (step && step->op == Op::OpVectorTimesScalar && isTmax(module, step->at(1)) &&
        spirv::loadsBuiltIn(module, step->at(0), spv::BuiltIn::WorldRayDirectionKHR) &&
        spirv::loadsBuiltIn(module, sum->at(1 - k), spv::BuiltIn::WorldRayOriginKHR))
      return true;
  }
  return false;
}

// What comparisons of a distance say about a miss.
struct Tests {
  bool sign = false;      // with a constant up to 0
  bool distance = false;  // with anything else
};

// A write of the distance of the ray to a leaf of the payload.
struct Write {
  const Edge* edge = nullptr;
  std::size_t instruction = 0;
};

class MissDistances {
 public:
  MissDistances(const CheckInput& input, Report& report) : graph_(input.graph), report_(report) {}

  void check() {
    for (const TraceSite& site : graph_.traces) {
      checkOrigin(site);
      const spirv::StageFacts& facts = graph_.facts(site);
      for (std::uint32_t leaf = 0; leaf < facts.leaves(site.trace->payload).count(); ++leaf) checkLeaf(site, leaf);
    }
  }

 private:
  // A miss shader that continues at the end of the ray.
  void checkOrigin(const TraceSite& site) {
    const PipelineStage& stage = graph_.stages[site.stage];
    const spirv::Module& module = graph_.facts(site).module();
    const auto ray = spirv::rayOperands(module.instructions()[site.trace->instruction]);
    if (stage.kind == shader::Stage::miss && ray && isEndOfRay(module, ray->origin))
      report_.addOncePerLine(
          "Q719", graph_.location(site),
          "the ray starts at the distance gl_RayTmaxEXT, but in a miss shader that is the tmax of the "
          "trace, and there is no surface");
  }

  void checkLeaf(const TraceSite& site, std::uint32_t leaf) {
    const std::vector<Write>& misses = writes(site, leaf, Role::miss);
    if (misses.empty() || writes(site, leaf, Role::closestHit).empty()) return;
    const Tests tests = testsOf(site, leaf);
    std::string text;
    if (tests.sign && !tests.distance)
      text =
          "the distance of a miss is gl_RayTmaxEXT, which is not negative, so the shader that traced the ray takes it "
          "for a hit";
    else if (!tests.sign && !tests.distance && continuesAlways(site, leaf))
      text =
          "the distance of a miss is gl_RayTmaxEXT, the tmax of the trace, and the shader that traced the ray "
          "continues "
          "there as if it were a hit";
    if (text.empty()) return;
    for (const Write& write : misses) {
      const spirv::Module& module = graph_.facts(*write.edge).module();
      const auto location = userLocation(module, module.instructions()[write.instruction]);
      if (location)
        report_.add("Q719", graph_.location(graph_.stages[write.edge->stage], *location), text,
                    {relatedTo(graph_.location(site), "traced here")});
    }
  }

  // The shaders of a role that store gl_RayTmaxEXT as it is; none if one of them stores something else.
  const std::vector<Write>& writes(const TraceSite& site, std::uint32_t leaf, Role role) {
    const auto [found, isNew] = writes_.try_emplace({site.targets, leaf, role});
    if (isNew) found->second = findWrites(site, leaf, role);
    return found->second;
  }

  std::vector<Write> findWrites(const TraceSite& site, std::uint32_t leaf, Role role) const {
    std::vector<Write> result;
    for (const Edge& edge : site.edges) {
      if (edge.role != role) continue;
      const spirv::StageFacts& facts = graph_.facts(edge);
      const spirv::SharedVariable* payload = facts.incoming(spv::StorageClass::IncomingRayPayloadKHR);
      if (!payload) continue;
      for (const spirv::AccessFacts& write : facts.accesses()) {
        if (!write.writes || write.variable != payload->id || !write.leaves.covers(leaf)) continue;
        if (!isTmax(facts.module(), facts.storedValue(write, leaf).id)) return {};
        result.push_back({&edge, write.instruction});
      }
    }
    return result;
  }

  // The values of the leaf that the stage reads after the trace.
  std::vector<Id> valuesAfter(const TraceSite& site, std::uint32_t leaf) const {
    const spirv::StageFacts& facts = graph_.facts(site);
    std::vector<Id> values;
    for (const std::size_t read : facts.readsAfter(site.trace->instruction, site.trace->payload, leaf))
      if (facts.accesses()[read].leaves.count() == 1) values.push_back(facts.accesses()[read].value);
    return values;
  }

  Tests testsOf(const TraceSite& site, std::uint32_t leaf) const {
    const spirv::Module& module = graph_.facts(site).module();
    Tests tests;
    for (const Id value : valuesAfter(site, leaf)) {
      (void)spirv::findInUses(module, value, [&](const spirv::Instruction& i) {
        if (module.types().get(i.type).kind != spirv::Type::Kind::boolean || i.operands.size() != 2) return false;
        const Id other = i.at(0) == value ? i.at(1) : i.at(0);
        const auto constant = module.constantFloat(other);
        const bool direct = i.at(0) == value || i.at(1) == value;
        (direct && constant && *constant <= 0.0 ? tests.sign : tests.distance) = true;
        return false;
      });
    }
    return tests;
  }

  // True if a later ray of the stage starts at a position that is computed with the leaf, and no condition depends on the
  // payload.
  bool continuesAlways(const TraceSite& site, std::uint32_t leaf) const {
    const spirv::StageFacts& facts = graph_.facts(site);
    const spirv::Module& module = facts.module();
    for (const spirv::Function& function : module.functions())
      for (const spirv::Block& block : function.blocks) {
        const spirv::Instruction& end = module.instructions()[block.end - 1];
        if ((end.op == Op::OpBranchConditional || end.op == Op::OpSwitch) &&
            facts.dependsOnVariable(end.at(0), site.trace->payload))
          return false;
      }
    const std::vector<Id> values = valuesAfter(site, leaf);
    return std::ranges::any_of(facts.traces(), [&](const spirv::TraceFacts& next) {
      const auto ray = spirv::rayOperands(module.instructions()[next.instruction]);
      return ray && spirv::dependsOn(module, ray->origin, [&](const spirv::Instruction& i) {
               return i.op == Op::OpVectorTimesScalar && std::ranges::find(values, i.at(1)) != values.end();
             });
    });
  }

  const PipelineGraph& graph_;
  Report& report_;
  std::map<std::tuple<std::size_t, std::uint32_t, Role>, std::vector<Write>> writes_;  // by targets, leaf and role
};

}  // namespace

void checkMissDistances(const CheckInput& input, Report& report) { MissDistances(input, report).check(); }

}  // namespace quintet::check
