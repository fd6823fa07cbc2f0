// SPDX-License-Identifier: Apache-2.0
// Q107: a part of a payload is read before anything has set it: in the tracing stage before its first trace, or in a
// shader that the trace runs, if no tracing stage sets it, or if it is certain that one of these stages does not. In a loop, shaders
// of the trace, and the code behind it, can set it for its next ray, but not for the first one.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "check/rules/across_stages/payload_receivers.h"
#include "check/rules/across_stages/shared_data.h"
#include "check/rules/rules.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::StorageClass;

// Which rays a search for what sets a part considers.
enum class Rays {
  any,   // shaders that the same trace ran for an earlier ray count
  first  // they do not, if nothing decides that the first ray runs other shaders
};

class InputRule {
 public:
  InputRule(const PipelineGraph& graph, const PayloadReceivers& receivers, Report& report)
      : graph_(graph), receivers_(receivers), report_(report) {}

  void check() {
    for (const PipelineStage& stage : graph_.stages) {
      if (!stage.facts) continue;
      for (const spirv::SharedVariable& variable : stage.facts->variables()) {
        if (variable.storage == StorageClass::RayPayloadKHR) checkSent(stage, variable);
        if (variable.storage == StorageClass::IncomingRayPayloadKHR) checkReceived(stage, variable);
      }
    }
  }

 private:
  void checkSent(const PipelineStage& stage, const spirv::SharedVariable& payload) {
    const spirv::StageFacts& facts = *stage.facts;
    const auto traced = [&](const spirv::TraceFacts& trace) { return trace.payload == payload.id; };
    if (std::ranges::none_of(facts.traces(), traced)) return;
    std::vector<LeafGroup> groups;
    for (std::uint32_t leaf = 0; leaf < facts.leaves(payload.id).count(); ++leaf)
      for (const std::size_t read : facts.inputReads(payload.id, leaf))
        addTo(groups, {"", " is read here, but no store to it and no trace with it comes before", ""}, leaf, read);
    for (const LeafGroup& group : groups)
      for (const std::string& part : facts.leaves(payload.id).names(group.leaves))
        report_.add("Q107", graph_.location(stage, locationOf(facts, facts.accesses()[group.read])),
                    nameOf(payload, part) + group.text.after);
  }

  void checkReceived(const PipelineStage& stage, const spirv::SharedVariable& payload) {
    const spirv::StageFacts& facts = *stage.facts;
    std::map<const TraceSite*, std::vector<LeafGroup>> groups;  // by the trace before which nothing sets the leaves
    for (std::uint32_t leaf = 0; leaf < facts.leaves(payload.id).count(); ++leaf) {
      std::vector<std::size_t> reads = facts.inputReads(payload.id, leaf);
      if (reads.empty()) continue;
      if (const TraceSite* unset = unsetTrace(stage, leaf, Rays::any)) {
        addTo(groups[unset], {}, leaf, reads.front());
        continue;
      }
      // A condition could tell the first ray from the others.
      std::erase_if(reads, [&](std::size_t i) { return !runsAlways(facts, facts.accesses()[i].instruction); });
      if (reads.empty()) continue;
      const TraceSite* unset = unsetTrace(stage, leaf, Rays::first);
      if (!unset) unset = unsetByStage(stage, leaf);
      if (unset) addTo(groups[unset], {"", isRepeated(*unset) ? "the first ray of " : "", ""}, leaf, reads.front());
    }
    for (const auto& [trace, leaves] : groups) {
      const SourceLocation origin = graph_.location(*trace);
      for (const LeafGroup& group : leaves) {
        for (const std::string& part : facts.leaves(payload.id).names(group.leaves)) {
          const std::string name = nameOf(payload, part);
          if (program::isLibraryStage(stage.file))
            report_.add("Q107", origin,
                        fmt::format("the {} shader '{}' reads {}, but nothing sets it before {}this trace",
                                    shader::stageName(stage.kind), stage.file, name, group.text.after));
          else
            report_.add("Q107", graph_.location(stage, locationOf(facts, facts.accesses()[group.read])),
                        fmt::format("{} is read here, but nothing sets it before {}the trace at {}:{}", name,
                                    group.text.after, origin.file, origin.line));
        }
      }
    }
  }

  std::size_t indexOf(const PipelineStage& stage) const {
    return static_cast<std::size_t>(&stage - graph_.stages.data());
  }

  // True if the trace is in a loop.
  bool isRepeated(const TraceSite& site) const {
    return spirv::canRunAfter(graph_.facts(site).module(), site.trace->instruction, site.trace->instruction);
  }

  // True if each path to the second instruction passes the first one.
  static bool dominates(const spirv::StageFacts& facts, std::size_t first, std::size_t second) {
    const auto from = facts.module().position(first), to = facts.module().position(second);
    if (!from || !to || from->function != to->function) return false;
    if (from->block == to->block) return first < second;
    return facts.flow(from->function).dominates(from->block, to->block);
  }

  // True if the instruction runs on each path through the stage.
  static bool runsAlways(const spirv::StageFacts& facts, std::size_t instruction) {
    const auto position = facts.module().position(instruction);
    const spirv::Function* entry = facts.module().entry();
    return position && entry && &facts.module().functions()[position->function] == entry &&
           facts.flow(position->function).controllers(position->block).empty();
  }

  // The first trace before which nothing sets the leaf that the stage receives; null if something does.
  const TraceSite* unsetTrace(const PipelineStage& stage, std::uint32_t leaf, Rays rays) const {
    std::set<std::size_t> seen;
    std::vector<const TraceSite*> unset;
    return isSet(indexOf(stage), leaf, rays, seen, unset) || unset.empty() ? nullptr : unset.front();
  }

  // The first trace of a stage that declares the payload, if no trace of this stage sets the leaf that the other stage receives,
  // and each certainly can run that one: what other stages set does not matter for these rays.
  const TraceSite* unsetByStage(const PipelineStage& stage, std::uint32_t leaf) const {
    const std::size_t receiver = indexOf(stage);
    std::map<std::size_t, const TraceSite*> unset;  // by tracing stage; null if one of its traces is not certain
    for (const TraceSite* site : receivers_.tracesTo(receiver)) {
      const spirv::SharedVariable* sent = graph_.facts(*site).variable(site->trace->payload);
      if (sent && sent->storage != StorageClass::RayPayloadKHR) continue;
      const bool certain = runsForEachRay(*site, receiver) && hitsAllMasks(*site) && sends(*site, receiver) &&
                           !setsBefore(*site, leaf, Rays::first) && !isReadUnwritten(*site, leaf);
      const auto [known, isNew] = unset.try_emplace(site->stage, certain ? site : nullptr);
      if (!isNew && !certain) known->second = nullptr;
    }
    const auto found = std::ranges::find_if(unset, [](const auto& entry) { return entry.second != nullptr; });
    return found == unset.end() ? nullptr : found->second;
  }

  static bool hitsAllMasks(const TraceSite& site) {
    return std::ranges::all_of(site.trace->mask.values, [](std::uint32_t mask) { return (mask & 0xFFu) == 0xFFu; });
  }

  // True if something can set the leaf of the payload that the stage receives. Adds the traces of stages that declare
  // the payload and do not set the leaf.
  bool isSet(std::size_t stage, std::uint32_t leaf, Rays rays, std::set<std::size_t>& seen,
             std::vector<const TraceSite*>& unset) const {
    if (!seen.insert(stage).second) return false;
    for (const TraceSite* site : receivers_.tracesTo(stage)) {
      if (rays == Rays::first && !runsForEachRay(*site, stage)) return true;
      if (!sends(*site, stage) || setsBefore(*site, leaf, rays)) return true;
      const spirv::StageFacts& tracer = graph_.facts(*site);
      const spirv::SharedVariable* sent = tracer.variable(site->trace->payload);
      if (sent->storage == StorageClass::IncomingRayPayloadKHR) {
        if (isSet(site->stage, leaf, rays, seen, unset)) return true;
      } else if (isReadUnwritten(*site, leaf)) {
        return true;  // Q104 reports it
      } else {
        unset.push_back(site);
      }
    }
    return false;
  }

  // True if the trace can run the stage for each of its rays: nothing that can differ between rays selects the record.
  bool runsForEachRay(const TraceSite& site, std::size_t stage) const {
    const spirv::TraceFacts& trace = *site.trace;
    for (const spirv::ArgumentValues* argument : {&trace.flags, &trace.mask, &trace.offset, &trace.stride, &trace.miss})
      if (!argument->exact()) return false;
    return std::ranges::any_of(receivers_.edges(site), [&](const Edge* edge) {
      return edge->exact && receivers_.kindOfStage(edge->stage) == receivers_.kindOfStage(stage);
    });
  }

  // True if the trace sends the type that the stage receives.
  bool sends(const TraceSite& site, std::size_t stage) const {
    return graph_.facts(site).variable(site.trace->payload) && receivers_.sameTypes(site)[receivers_.classOf(stage)];
  }

  // True if the stage reads the leaf after the trace, which can end without writing it.
  bool isReadUnwritten(const TraceSite& site, std::uint32_t leaf) const {
    if (graph_.facts(site).unguardedReads(site.trace->instruction, site.trace->payload, leaf).empty()) return false;
    const auto leaves = [&](const Edge* edge) {
      if (edge->role != Role::miss && edge->role != Role::closestHit) return false;
      const PayloadReceiver& receiver = receivers_.of(edge->stage);
      return leaf >= receiver.writesAlways.size() || !receiver.writesAlways[leaf];
    };
    const auto unshaded = [&](HitGroupRay hit) {
      return site.skipsClosestHit() || graph_.shaders(hit).closestHit.empty();
    };
    return std::ranges::any_of(receivers_.edges(site), leaves) || std::ranges::any_of(receivers_.hits(site), unshaded);
  }

  // True if the tracing stage, or a shader that it runs before, sets the leaf without reading it first.
  bool setsBefore(const TraceSite& site, std::uint32_t leaf, Rays rays) const {
    const auto [known, isNew] = setsBefore_.try_emplace({&site, leaf, rays}, false);
    if (isNew) known->second = findSetsBefore(site, leaf, rays);
    return known->second;
  }

  bool findSetsBefore(const TraceSite& site, std::uint32_t leaf, Rays rays) const {
    const spirv::StageFacts& tracer = graph_.facts(site);
    const spirv::Id sent = site.trace->payload;
    const bool own = tracer.variable(sent)->storage == StorageClass::RayPayloadKHR;
    // A write after the trace in a loop is for the next ray.
    const auto writes = [&](const spirv::AccessFacts& a) {
      return a.writes && a.variable == sent && a.leaves.covers(leaf) &&
             (rays == Rays::any || !own || !dominates(tracer, site.trace->instruction, a.instruction));
    };
    if (std::ranges::any_of(tracer.accesses(), writes) && (own || !tracer.readsBeforeWriting(sent, leaf))) return true;
    for (const TraceSite& other : graph_.tracesOf(site.stage)) {
      if (other.trace->payload != sent) continue;
      const bool before = spirv::canRunAfter(tracer.module(), site.trace->instruction, other.trace->instruction) &&
                          (&other != &site || rays == Rays::any);
      for (const Edge* edge : receivers_.edges(other)) {
        if (edge->role == Role::intersection || (!before && edge->role != Role::anyHit)) continue;
        const PayloadReceiver& receiver = receivers_.of(edge->stage);
        if (!receiver.payload) continue;
        if (!sends(other, edge->stage) ||
            (leaf < receiver.writes.size() && receiver.writes[leaf] && !receiver.readsIn[leaf]))
          return true;
      }
    }
    return false;
  }

  const PipelineGraph& graph_;
  const PayloadReceivers& receivers_;
  Report& report_;
  mutable std::map<std::tuple<const TraceSite*, std::uint32_t, Rays>, bool> setsBefore_;  // cache
};

}  // namespace

void checkPayloadInputs(const CheckInput& input, const PayloadReceivers& receivers, Report& report) {
  InputRule(input.graph, receivers, report).check();
}

}  // namespace quintet::check
