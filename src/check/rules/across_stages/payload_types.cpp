// SPDX-License-Identifier: Apache-2.0
// Q101 to Q103, Q106: types, locations and qualifiers of payloads. Q301, Q303: types and locations of callable data.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "check/rules/across_stages/payload_receivers.h"
#include "check/rules/rules.h"
#include "spirv/source_text.h"

namespace quintet::check {
namespace {

using spv::StorageClass;

// The variable that a trace or call sends and the one that a reached shader receives.
struct Pair {
  std::size_t site = 0;  // in the list of sites
  const Edge* edge = nullptr;
  std::size_t receiver = 0;  // equal for stages that the rule cannot distinguish
  const spirv::SharedVariable* sent = nullptr;
  const spirv::SharedVariable* received = nullptr;
  std::optional<std::string> difference;  // of their types; nullopt if they agree
  bool alternative = false;               // the site may run a shader instead that receives nothing
  bool unsure = false;                    // the site may not run the shader at all
};

spirv::Id sentVariable(const TraceSite& site) { return site.trace->payload; }
spirv::Id sentVariable(const CallSite& site) { return site.call->data; }
bool mayRunNothing(const TraceSite& site) { return site.mayRunNothing; }
bool mayRunNothing(const CallSite&) { return false; }

// A miss index beyond the miss shaders that are given names a record without a shader, or of a shader that is not given.
bool missesNone(const PipelineGraph& graph, const TraceSite& site) {
  const spirv::ArgumentValues& miss = site.trace->miss;
  return !graph.groups.tablesKnown && miss.certain() &&
         std::ranges::all_of(miss.values, [&](std::uint32_t v) { return (v & 0xFFFFu) >= graph.groups.misses.size(); });
}
bool missesNone(const PipelineGraph&, const CallSite&) { return false; }

// True if there are more shaders than indices that the sites use, so that at least one of them is unused. The order of the
// shaders is unknown.
template <class Site, class Index>
bool hasUnused(const std::vector<Site>& sites, std::size_t shaders, const Index& indexOf) {
  std::set<std::uint32_t> used;
  for (const Site& site : sites) {
    const spirv::ArgumentValues& index = indexOf(site);
    if (!index.known) return false;
    used.insert(index.values.begin(), index.values.end());
  }
  return used.size() < shaders;
}

struct Unused {
  bool miss = false, callable = false;  // a shader of this kind runs for no trace or call
};

Unused unusedOf(const PipelineGraph& graph) {
  if (graph.groups.tablesKnown) return {};
  return {hasUnused(
              graph.traces, graph.groups.misses.size(),
              [](const TraceSite& site) -> const auto& { return site.trace->miss; }),
          hasUnused(
              graph.calls, graph.groups.callables.size(),
              [](const CallSite& site) -> const auto& { return site.call->index; })};
}

// All edges of the sites.
struct AllEdges {
  template <class Site>
  std::vector<const Edge*> of(const Site& site) const {
    std::vector<const Edge*> result;
    for (const Edge& edge : site.edges) result.push_back(&edge);
    return result;
  }
  std::size_t receiver(const Edge& edge) const { return edge.stage; }
};

// The first ones of equal edges.
struct KindsOfEdges {
  const PayloadReceivers& receivers;
  const std::vector<const Edge*>& of(const TraceSite& site) const { return receivers.edges(site); }
  std::size_t receiver(const Edge& edge) const { return receivers.kindOfStage(edge.stage); }
};

template <class Site, class Edges>
std::vector<Pair> pairsOf(const PipelineGraph& graph, const std::vector<Site>& sites, StorageClass incoming,
                          const Edges& edges) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const spirv::StageFacts& sender = graph.facts(sites[i]);
    const spirv::SharedVariable* sent = sender.variable(sentVariable(sites[i]));
    const std::vector<const Edge*>& ofSite = edges.of(sites[i]);
    const auto mayReceiveNothing = [&](Role role) {
      return std::ranges::any_of(ofSite, [&](const Edge* edge) {
        return edge->role == role && !edge->exact && !graph.facts(*edge).incoming(incoming);
      });
    };
    const bool silentMiss = mayReceiveNothing(Role::miss) || missesNone(graph, sites[i]);
    const bool silentCall = mayReceiveNothing(Role::callable);
    for (const Edge* edge : ofSite) {
      if (edge->role == Role::intersection) continue;
      const spirv::StageFacts& receiver = graph.facts(*edge);
      const spirv::SharedVariable* received = receiver.incoming(incoming);
      if (!sent || !received) continue;
      pairs.push_back(
          {i, edge, edges.receiver(*edge), sent, received,
           spirv::differenceOf(sender.module().types(), sent->type, receiver.module().types(), received->type),
           edge->role == Role::miss ? silentMiss : edge->role == Role::callable && silentCall,
           mayRunNothing(sites[i])});
    }
  }
  return pairs;
}

// Without groups: the shaders whose payload a trace sends, but which its flags exclude. The flags are then unusual, not the
// payload. Numbers of PayloadReceivers::kindOfStage().
std::set<std::size_t> excludedReceivers(const PipelineGraph& graph, const PayloadReceivers& receivers) {
  std::set<std::size_t> result;
  if (graph.groups.groupsKnown || graph.groups.tablesKnown) return result;
  std::set<std::pair<std::size_t, const std::vector<bool>*>> seen;
  for (const TraceSite& site : graph.traces) {
    const bool excludes = site.trace->flags.mustHave(kFlagOpaque) || site.skipsClosestHit();
    if (!excludes || !graph.facts(site).variable(site.trace->payload)) continue;
    const std::vector<bool>& same = receivers.sameTypes(site);
    if (!seen.insert({site.targets, &same}).second) continue;
    for (const HitGroupRay hit : site.hits) {
      for (const std::string& file : {graph.shaders(hit).anyHit, graph.shaders(hit).closestHit}) {
        const PipelineStage* stage = graph.stage(file);
        if (!stage || !stage->facts || !stage->facts->incoming(StorageClass::IncomingRayPayloadKHR)) continue;
        const auto index = static_cast<std::size_t>(stage - graph.stages.data());
        const std::span<const Edge> edges = edgesOf(site.edges, hit);
        const bool runs = std::ranges::find(edges, index, &Edge::stage) != edges.end();
        if (!runs && same[receivers.classOf(index)]) result.insert(receivers.kindOfStage(index));
      }
    }
  }
  return result;
}

// With dynamic arguments, a trace or call is assumed to reach more shaders than it does. A difference is then an error
// only if one side differs in all of its pairs.
class TypeErrors {
 public:
  // `others`: receivers that agree with a site that does not run them.
  TypeErrors(const PipelineGraph& graph, const std::vector<Pair>& pairs, std::set<std::size_t> others = {})
      : graph_(graph), unused_(unusedOf(graph)), receivers_(std::move(others)) {
    for (const Pair& pair : pairs) {
      if (pair.difference && pair.edge->exact) receiversOfExact_.insert(pair.receiver);
      if (pair.alternative) silent_.insert(pair.site);
      if (pair.difference) continue;
      receivers_.insert(pair.receiver);
      senders_.insert({pair.site, pair.edge->role == Role::miss});
    }
    for (const Pair& pair : pairs) {
      if (!pair.difference || receiverAgrees(pair) || senderAgrees(pair)) continue;
      receiversOfBoth_.insert(pair.receiver);
      sendersOfBoth_.insert({pair.site, pair.edge->role == Role::miss});
    }
  }

  // Whether isError() can return true for the pair or, if equal receivers have one pair, for an edge to one of them.
  bool canBeError(const Pair& pair) const {
    if (!pair.difference) return false;
    if (pair.edge->exact) return true;
    if (receiversOfExact_.contains(pair.receiver)) return false;  // that error is certain
    if (!graph_.error.empty()) return false;  // the other side can be a stage that cannot be analyzed
    if (pair.unsure)
      return !silent_.contains(pair.site) && !senders_.contains({pair.site, false}) &&
             !senders_.contains({pair.site, true});
    const bool receiver = receiverAgrees(pair), sender = senderAgrees(pair);
    // A pipeline can have groups that its table does not have, and a table can have records without a shader.
    const PipelineGroups& groups = graph_.groups;
    // What sends to the shader, or receives from the trace, can be code that the constants of a variant exclude.
    if ((groups.groupsKnown && !groups.tablesKnown) || graph_.hasVariants) return !receiver && !sender;
    if (groups.tablesKnown) return !receiver || (!hitMayEnd(pair) && !sender);
    // Any shader can be the one that is meant. It is the one that also fits to nothing, if there is one.
    if (!receiver && !sender) return true;
    if (!receiver) return !canBeUnused(pair) && !receiversOfBoth_.contains(pair.receiver);
    return !sender && !hitMayEnd(pair) && !sendersOfBoth_.contains(senderOf(pair));
  }

  // Call it once for each edge of a pair that can be an error, in their order.
  bool isError(const Pair& pair, const Edge& edge) {
    if (!canBeError(pair)) return false;
    const PipelineGroups& groups = graph_.groups;
    if (pair.unsure) return reportedSenders_.insert({pair.site, false}).second;
    if (pair.edge->exact || groups.groupsKnown || groups.tablesKnown) return true;
    const bool receiver = receiverAgrees(pair), sender = senderAgrees(pair);
    if (!receiver && !sender) return true;
    return receiver ? reportedSenders_.insert(senderOf(pair)).second : reported_.insert(edge.stage).second;
  }

 private:
  // A shader that matches no site can be one that nothing runs.
  bool canBeUnused(const Pair& pair) const {
    return (pair.edge->role == Role::miss && unused_.miss) || (pair.edge->role == Role::callable && unused_.callable);
  }

  using Sender = std::pair<std::size_t, bool>;  // the site, and whether its misses are meant

  // A hit can end without a closest-hit shader.
  bool hitMayEnd(const Pair& pair) const {
    const bool isHit = pair.edge->role != Role::miss && pair.edge->role != Role::callable;
    return isHit && graph_.groups.hitRecords == HitRecords::byRecord;
  }
  static Sender senderOf(const Pair& pair) { return {pair.site, pair.edge->role == Role::miss}; }
  bool receiverAgrees(const Pair& pair) const { return receivers_.contains(pair.receiver); }
  bool senderAgrees(const Pair& pair) const {
    return pair.alternative || senders_.contains({pair.site, pair.edge->role == Role::miss});
  }

  const PipelineGraph& graph_;
  const Unused unused_;
  std::set<std::size_t> receivers_, receiversOfExact_, receiversOfBoth_;  // Pair::receiver
  std::set<std::size_t> silent_;                                          // sites with an alternative
  std::set<std::size_t> reported_;                                        // stages
  std::set<Sender> senders_, sendersOfBoth_, reportedSenders_;
};

// A stage that receives at a location cannot send at the same location: a different location is then intended.
bool locationsDiffer(const spirv::StageFacts& sender, const Pair& pair) {
  const auto& sent = pair.sent->location;
  const auto& received = pair.received->location;
  if (!sent || !received || sent == received) return false;
  const spirv::SharedVariable* own = sender.incoming(pair.received->storage);
  return !own || own->location != received;
}

// The ids and the words of the diagnostics for traces and for calls.
struct Wording {
  std::string_view typeId, locationId;
  std::string_view data;  // "the payload"
};

constexpr Wording kPayloads{"Q101", "Q102", "the payload"};
constexpr Wording kCallableData{"Q301", "Q303", "the data"};

std::string_view nounOf(const TraceSite& site) { return site.noun(); }
std::string_view nounOf(const CallSite&) { return "call"; }

// The declarations of both ends.
std::vector<RelatedLocation> endsOf(const PipelineGraph& graph, const PipelineStage& sender, const Pair& pair) {
  const PipelineStage& receiver = graph.stages[pair.edge->stage];
  const auto text = [](std::string_view verb, const PipelineStage& stage, const spirv::SharedVariable& variable) {
    return fmt::format("{} here as {}", verb, stage.facts->module().types().describe(variable.type));
  };
  return {relatedTo(graph.declarationOf(sender, *pair.sent), text("sent", sender, *pair.sent)),
          relatedTo(graph.declarationOf(receiver, *pair.received), text("received", receiver, *pair.received))};
}

template <class Site>
void reportPair(const PipelineGraph& graph, const Site& site, const Pair& pair, const Wording& wording,
                Report& report) {
  const spirv::StageFacts& sender = graph.facts(site);
  const spirv::StageFacts& receiver = graph.facts(*pair.edge);
  report.add(wording.typeId, graph.location(site),
             fmt::format("{} of this {} is {}, but the {} expects {}: {}", wording.data, nounOf(site),
                         sender.module().types().describe(pair.sent->type), graph.describe(*pair.edge),
                         receiver.module().types().describe(pair.received->type), *pair.difference),
             endsOf(graph, graph.stages[site.stage], pair));
}

void checkCallPairs(const PipelineGraph& graph, Report& report) {
  const std::vector<Pair> pairs = pairsOf(graph, graph.calls, StorageClass::IncomingCallableDataKHR, AllEdges{});
  TypeErrors errors(graph, pairs);
  for (const Pair& pair : pairs)
    if (errors.isError(pair, *pair.edge)) reportPair(graph, graph.calls[pair.site], pair, kCallableData, report);
}

void checkTracePairs(const PipelineGraph& graph, const PayloadReceivers& receivers, Report& report) {
  const std::vector<Pair> pairs =
      pairsOf(graph, graph.traces, StorageClass::IncomingRayPayloadKHR, KindsOfEdges{receivers});
  TypeErrors errors(graph, pairs, excludedReceivers(graph, receivers));
  for (auto first = pairs.begin(); first != pairs.end();) {
    const auto last = std::find_if(first, pairs.end(), [&](const Pair& pair) { return pair.site != first->site; });
    const TraceSite& site = graph.traces[first->site];
    std::map<const Edge*, const Pair*> wrong;  // by the first edge of its kind
    for (auto pair = first; pair != last; ++pair)
      if (errors.canBeError(*pair)) wrong[pair->edge] = &*pair;
    first = last;
    if (wrong.empty()) continue;
    for (std::size_t i = 0; i < site.edges.size(); ++i) {
      const auto found = wrong.find(receivers.edges(site)[receivers.kindOf(site, i)]);
      if (found == wrong.end() || !errors.isError(*found->second, site.edges[i])) continue;
      // Only names can differ from those of the first one.
      Pair pair = *found->second;
      const spirv::StageFacts& receiver = graph.facts(site.edges[i]);
      pair.edge = &site.edges[i];
      pair.received = receiver.incoming(StorageClass::IncomingRayPayloadKHR);
      pair.difference = spirv::differenceOf(graph.facts(site).module().types(), pair.sent->type,
                                            receiver.module().types(), pair.received->type);
      if (pair.difference) reportPair(graph, site, pair, kPayloads, report);
    }
  }
}

template <class Site>
void checkLocations(const PipelineGraph& graph, const std::vector<Site>& sites, StorageClass incoming,
                    const Wording& wording, Report& report) {
  for (const Pair& pair : pairsOf(graph, sites, incoming, AllEdges{})) {
    const Site& site = sites[pair.site];
    const SourceLocation location = graph.location(site);
    if (pair.difference || !pair.edge->exact || !locationsDiffer(graph.facts(site), pair)) continue;
    report.add(wording.locationId, graph.location(graph.stages[pair.edge->stage], pair.received->declaration),
               fmt::format("'{}' has location {} here, but the {} at {}:{} sends location {}", pair.received->name,
                           *pair.received->location, nounOf(site), location.file, location.line, *pair.sent->location),
               {relatedTo(location, fmt::format("the {}", nounOf(site))),
                relatedTo(graph.declarationOf(graph.stages[site.stage], *pair.sent),
                          fmt::format("location {} is sent", *pair.sent->location))});
  }
}

// The first trace that can run the stage.
std::vector<RelatedLocation> firstTraceOf(const PipelineGraph& graph, const PipelineStage& stage) {
  for (const TraceSite& site : graph.traces)
    for (const Edge& edge : site.edges)
      if (&graph.stages[edge.stage] == &stage)
        return {
            relatedTo(graph.location(site), fmt::format("this {} runs the shader with its own payload", site.noun()))};
  return {};
}

// Returns the last argument of the call that starts at `at`; empty if the call does not end.
std::string_view lastArgument(std::string_view text, std::size_t at) {
  const std::size_t open = text.find('(', at);
  std::size_t begin = open;
  int depth = 0;
  for (std::size_t i = open; i < text.size(); ++i) {
    if (text[i] == '(') ++depth;
    if (text[i] == ',' && depth == 1) begin = i;
    if (text[i] != ')' || --depth > 0) continue;
    std::string_view argument = text.substr(begin + 1, i - begin - 1);
    argument.remove_prefix(std::min(argument.find_first_not_of(" \t\r\n"), argument.size()));
    return argument.substr(0, argument.find_last_not_of(" \t\r\n") + 1);
  }
  return {};
}

// True if the source has a trace with the payload that the compiler removed: #if, a constant condition.
bool hasRemovedTrace(const spirv::StageFacts& facts, const spirv::SharedVariable& payload) {
  if (!payload.location) return false;
  for (const auto& [file, text] : facts.module().sources()) {
    for (const std::string_view call : {"traceRayEXT", "hitObjectTraceRayNV", "hitObjectExecuteShaderNV",
                                        "hitObjectTraceRayEXT", "hitObjectExecuteShaderEXT"})
      for (std::size_t at = spirv::findToken(text, call); at != text.npos; at = spirv::findToken(text, call, at + 1))
        if (lastArgument(text, at) == std::to_string(*payload.location)) return true;
  }
  return false;
}

// Q106: Vulkan allows one variable of these storage classes in the interface of a stage
// (VUID-StandaloneSpirv-IncomingRayPayloadKHR-04700, VUID-StandaloneSpirv-IncomingCallableDataKHR-04706).
void checkIncoming(const PipelineGraph& graph, StorageClass storage, std::string_view qualifier, Report& report) {
  for (const PipelineStage& stage : graph.stages) {
    if (!stage.facts) continue;
    const spirv::SharedVariable* first = nullptr;
    for (const spirv::SharedVariable& variable : stage.facts->variables()) {
      if (variable.storage != storage || !variable.used) continue;
      if (first)
        report.add(
            "Q106", graph.location(stage, variable.declaration),
            fmt::format("'{}' is the second {} that this {} shader uses; the first one is '{}' (line {})",
                        variable.name, qualifier, shader::stageName(stage.kind), first->name, first->declaration.line));
      else
        first = &variable;
    }
  }
}

// Q103: an outgoing payload in a shader that never traces with it.
void checkQualifiers(const PipelineGraph& graph, Report& report) {
  for (const PipelineStage& stage : graph.stages) {
    const bool receives = stage.kind == shader::Stage::closestHit || stage.kind == shader::Stage::miss ||
                          stage.kind == shader::Stage::anyHit;
    if (!receives || !stage.facts || !stage.problem.empty()) continue;  // traces that are not followed
    for (const spirv::SharedVariable& variable : stage.facts->variables()) {
      const bool traced =
          std::ranges::any_of(stage.facts->traces(), [&](const auto& trace) { return trace.payload == variable.id; });
      if (variable.storage != StorageClass::RayPayloadKHR || !variable.used || traced) continue;
      if (stage.facts->incoming(StorageClass::IncomingRayPayloadKHR) || hasRemovedTrace(*stage.facts, variable))
        continue;
      report.add("Q103", graph.location(stage, variable.declaration),
                 fmt::format("'{}' is a rayPayloadEXT, but no trace of this {} shader uses it; declare the payload of "
                             "the incoming ray as rayPayloadInEXT",
                             variable.name, shader::stageName(stage.kind)),
                 firstTraceOf(graph, stage));
    }
  }
}

}  // namespace

void checkPayloadTypes(const CheckInput& input, const PayloadReceivers& receivers, Report& report) {
  checkTracePairs(input.graph, receivers, report);
  checkQualifiers(input.graph, report);
  checkIncoming(input.graph, StorageClass::IncomingRayPayloadKHR, "rayPayloadInEXT", report);
  checkIncoming(input.graph, StorageClass::IncomingCallableDataKHR, "callableDataInEXT", report);
}

void checkCallableTypes(const CheckInput& input, Report& report) { checkCallPairs(input.graph, report); }

void checkSharedLocations(const ProgramInput& input, Report& report) {
  checkLocations(input.graph, input.graph.traces, StorageClass::IncomingRayPayloadKHR, kPayloads, report);
  checkLocations(input.graph, input.graph.calls, StorageClass::IncomingCallableDataKHR, kCallableData, report);
}

}  // namespace quintet::check
