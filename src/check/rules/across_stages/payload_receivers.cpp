// SPDX-License-Identifier: Apache-2.0
#include "check/rules/across_stages/payload_receivers.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "base/parallel.h"
#include "check/rules/across_stages/shared_data.h"

namespace quintet::check {
namespace {

using spv::StorageClass;

// Equal for variables whose types compare equally with those of all other stages; empty if that is unknown.
std::string typeKey(const spirv::StageFacts& facts, const spirv::SharedVariable& variable) {
  const std::string signature = facts.module().types().signature(variable.type);
  return signature.empty() ? signature : fmt::format("{} {}", facts.leaves(variable.id).count(), signature);
}

bool hasWrongQualifier(const spirv::StageFacts& facts) {
  return !facts.incoming(StorageClass::IncomingRayPayloadKHR) &&
         std::ranges::any_of(facts.variables(), [&](const auto& v) {
           return v.storage == StorageClass::RayPayloadKHR && v.used &&
                  std::ranges::none_of(facts.traces(), [&](const auto& t) { return t.payload == v.id; });
         });
}

PayloadReceiver receiverOf(const spirv::StageFacts& facts) {
  PayloadReceiver receiver;
  receiver.facts = &facts;
  receiver.payload = facts.incoming(StorageClass::IncomingRayPayloadKHR);
  receiver.hasEffects = hasEffects(facts);
  receiver.wrongQualifier = hasWrongQualifier(facts);
  if (!receiver.payload) return receiver;
  const spirv::Id payload = receiver.payload->id;
  for (std::uint32_t leaf = 0; leaf < facts.leaves(payload).count(); ++leaf) {
    receiver.writes.push_back(facts.writes(payload, leaf));
    receiver.writesAlways.push_back(facts.writesAlways(payload, leaf));
    receiver.readsIn.push_back(facts.readsBeforeWriting(payload, leaf));
  }
  return receiver;
}

// Equal for receivers of the same class; empty if the stage is a class of its own.
std::string keyOf(const PayloadReceiver& receiver) {
  std::string key = fmt::format("{}{}", receiver.hasEffects ? 'e' : '-', receiver.wrongQualifier ? 'q' : '-');
  if (!receiver.payload) return key;
  const std::string type = typeKey(*receiver.facts, *receiver.payload);
  if (type.empty() || receiver.facts->hasUnknownConstants()) return {};
  for (std::size_t leaf = 0; leaf < receiver.writes.size(); ++leaf) {
    // On which path a leaf is written can depend on the values of others (unwritten_paths.h).
    if (receiver.writes[leaf] && !receiver.writesAlways[leaf]) return {};
    key += receiver.writesAlways[leaf] ? 'w' : '-';
    key += receiver.readsIn[leaf] ? 'r' : '-';
  }
  return key + type;
}

}  // namespace

PayloadReceivers::PayloadReceivers(const PipelineGraph& graph) : graph_(graph) {
  addClasses(graph);
  addKinds(graph);
  for (const TraceTargets& targets : graph.targets) addTargets(graph, targets);
}

void PayloadReceivers::addClasses(const PipelineGraph& graph) {
  const std::size_t count = graph.stages.size();
  std::vector<PayloadReceiver> receivers(count);
  std::vector<std::string> keys(count);
  parallelFor(count, [&](std::size_t i) {
    if (!graph.stages[i].facts) return;
    receivers[i] = receiverOf(*graph.stages[i].facts);
    if (graph.mergesEqual) keys[i] = keyOf(receivers[i]);
  });
  std::map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = classes_.size();
    const std::size_t found = keys[i].empty() ? next : known.try_emplace(std::move(keys[i]), next).first->second;
    classOf_.push_back(found);
    if (found == next) classes_.push_back(std::move(receivers[i]));
  }
}

void PayloadReceivers::addKinds(const PipelineGraph& graph) {
  // The edges to each stage: targets, role, exact.
  using Use = std::tuple<std::size_t, Role, bool>;
  std::vector<std::vector<Use>> uses(graph.stages.size());
  tracesTo_.resize(graph.stages.size());
  for (std::size_t t = 0; t < graph.targets.size(); ++t)
    for (const Edge& edge : graph.targets[t].edges) {
      const Use use{t, edge.role, edge.exact};
      if (uses[edge.stage].empty() || uses[edge.stage].back() != use) uses[edge.stage].push_back(use);
      std::vector<std::size_t>& tracesTo = tracesTo_[edge.stage];
      if (edge.role != Role::intersection && (tracesTo.empty() || tracesTo.back() != t)) tracesTo.push_back(t);
    }
  std::map<std::pair<std::size_t, std::vector<Use>>, std::size_t> known;
  for (std::size_t i = 0; i < graph.stages.size(); ++i) {
    std::vector<Use>& all = uses[i];
    std::ranges::sort(all);
    all.erase(std::unique(all.begin(), all.end()), all.end());
    kindOfStage_.push_back(
        graph.mergesEqual ? known.try_emplace({classOf_[i], std::move(all)}, known.size()).first->second : i);
  }
}

void PayloadReceivers::addTargets(const PipelineGraph& graph, const TraceTargets& targets) {
  constexpr std::size_t kNone = ~std::size_t{0};
  const auto anyHitOf = [&](HitGroupRay hit) {
    for (const Edge& edge : edgesOf(targets.edges, hit))
      if (edge.role == Role::anyHit) return kindOfStage_[edge.stage];
    return kNone;
  };
  std::map<std::tuple<Role, bool, std::size_t, std::size_t>, std::size_t> known;
  std::vector<const Edge*>& edges = edges_.emplace_back();
  std::vector<std::size_t>& kindOf = kindOf_.emplace_back();
  for (const Edge& edge : targets.edges) {
    const std::size_t anyHit = edge.role == Role::closestHit ? anyHitOf(edge.hit) : kNone;
    const auto [found, isNew] =
        known.try_emplace({edge.role, edge.exact, kindOfStage_[edge.stage], anyHit}, edges.size());
    if (isNew) edges.push_back(&edge);
    kindOf.push_back(found->second);
  }
  std::map<std::pair<bool, std::size_t>, std::size_t> knownHits;
  std::vector<HitGroupRay>& hits = hits_.emplace_back();
  for (const HitGroupRay hit : targets.hits)
    if (knownHits.try_emplace({graph.shaders(hit).closestHit.empty(), anyHitOf(hit)}, 0).second || !graph.mergesEqual)
      hits.push_back(hit);
}

std::vector<const TraceSite*> PayloadReceivers::tracesTo(std::size_t stage) const {
  std::vector<const TraceSite*> result;
  for (const std::size_t targets : tracesTo_[stage])
    for (const std::size_t trace : graph_.targets[targets].traces) result.push_back(&graph_.traces[trace]);
  if (tracesTo_[stage].size() > 1) std::ranges::sort(result);  // they are elements of one vector
  return result;
}

const std::vector<bool>& PayloadReceivers::sameTypes(const TraceSite& site) const {
  const spirv::StageFacts& sender = graph_.facts(site);
  const spirv::SharedVariable* sent = sender.variable(site.trace->payload);
  std::string key = sent ? typeKey(sender, *sent) : "-";
  if (key.empty() || (sent && !graph_.mergesEqual)) key = fmt::format("{} {}", site.stage, sent->id);
  const auto [found, isNew] = sameTypes_.try_emplace(std::move(key));
  if (!isNew) return found->second;
  for (const PayloadReceiver& receiver : classes_) {
    // Without values of specialization constants, one of two equal types can have fewer leaves.
    const auto agree = [&] {
      return sent &&
             !differenceOf(sender.module().types(), sent->type, receiver.facts->module().types(),
                           receiver.payload->type) &&
             sender.leaves(sent->id).count() == receiver.facts->leaves(receiver.payload->id).count();
    };
    found->second.push_back(!receiver.payload || agree());
  }
  return found->second;
}

}  // namespace quintet::check
