// SPDX-License-Identifier: Apache-2.0
// Q101 to Q103: types, locations and qualifiers of payloads. Q301, Q303: types and locations of callable data.
#include <fmt/format.h>

#include <algorithm>

#include "check/rules/rules.h"

namespace quintet::check {
namespace {

using spv::StorageClass;

// The variable that a trace or call sends and the one that a reached shader receives.
struct Pair {
  std::size_t site = 0;  // in the list of sites
  const Edge* edge = nullptr;
  const spirv::SharedVariable* sent = nullptr;
  const spirv::SharedVariable* received = nullptr;
  std::optional<std::string> difference;  // of their types; nullopt if they agree
};

spirv::Id sentVariable(const TraceSite& site) { return site.trace->payload; }
spirv::Id sentVariable(const CallSite& site) { return site.call->data; }

template <class Site>
std::vector<Pair> pairsOf(const PipelineGraph& graph, const std::vector<Site>& sites, StorageClass incoming) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const spirv::StageFacts& sender = graph.facts(sites[i]);
    const spirv::SharedVariable* sent = sender.variable(sentVariable(sites[i]));
    for (const Edge& edge : sites[i].edges) {
      if (edge.role == Role::intersection) continue;
      const spirv::StageFacts& receiver = graph.facts(edge);
      const spirv::SharedVariable* received = receiver.incoming(incoming);
      if (!sent || !received) continue;
      pairs.push_back(
          {i, &edge, sent, received,
           spirv::differenceOf(sender.module().types(), sent->type, receiver.module().types(), received->type)});
    }
  }
  return pairs;
}

// With dynamic arguments, a trace or call is assumed to reach more shaders than it does. A difference is then an error
// only if one side differs in all of its pairs.
bool isTypeError(const std::vector<Pair>& pairs, const Pair& pair) {
  if (!pair.difference) return false;
  if (pair.edge->exact) return true;
  const auto agrees = [&](auto related) {
    return std::ranges::any_of(pairs, [&](const Pair& p) { return !p.difference && related(p); });
  };
  const bool receiverAgrees = agrees([&](const Pair& p) { return p.edge->stage == pair.edge->stage; });
  const bool senderAgrees = agrees([&](const Pair& p) {
    return p.site == pair.site && (p.edge->role == Role::miss) == (pair.edge->role == Role::miss);
  });
  return !receiverAgrees || !senderAgrees;
}

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
  std::string_view data;  // "the payload of this trace"
  std::string_view site;  // "trace"
};

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
void checkPairs(const PipelineGraph& graph, const std::vector<Site>& sites, StorageClass incoming,
                const Wording& wording, Report& report) {
  const std::vector<Pair> pairs = pairsOf(graph, sites, incoming);
  for (const Pair& pair : pairs) {
    const Site& site = sites[pair.site];
    const spirv::StageFacts& sender = graph.facts(site);
    const spirv::StageFacts& receiver = graph.facts(*pair.edge);
    const SourceLocation location = graph.location(site);
    if (isTypeError(pairs, pair)) {
      report.add(wording.typeId, location,
                 fmt::format("{} is {}, but the {} expects {}: {}", wording.data,
                             sender.module().types().describe(pair.sent->type), graph.describe(*pair.edge),
                             receiver.module().types().describe(pair.received->type), *pair.difference),
                 endsOf(graph, graph.stages[site.stage], pair));
    } else if (!pair.difference && pair.edge->exact && locationsDiffer(sender, pair)) {
      report.add(
          wording.locationId, graph.location(graph.stages[pair.edge->stage], pair.received->declaration),
          fmt::format("'{}' has location {} here, but the {} at {}:{} sends location {}", pair.received->name,
                      *pair.received->location, wording.site, location.file, location.line, *pair.sent->location),
          {relatedTo(location, fmt::format("the {}", wording.site)),
           relatedTo(graph.declarationOf(graph.stages[site.stage], *pair.sent),
                     fmt::format("location {} is sent", *pair.sent->location))});
    }
  }
}

// The first trace that can run the stage.
std::vector<RelatedLocation> firstTraceOf(const PipelineGraph& graph, const PipelineStage& stage) {
  for (const TraceSite& site : graph.traces)
    for (const Edge& edge : site.edges)
      if (&graph.stages[edge.stage] == &stage)
        return {relatedTo(graph.location(site), "this trace runs the shader with its own payload")};
  return {};
}

// Q103: an outgoing payload in a shader that never traces with it.
void checkQualifiers(const PipelineGraph& graph, Report& report) {
  for (const PipelineStage& stage : graph.stages) {
    const bool receives = stage.kind == shader::Stage::closestHit || stage.kind == shader::Stage::miss ||
                          stage.kind == shader::Stage::anyHit;
    if (!receives || !stage.facts) continue;
    for (const spirv::SharedVariable& variable : stage.facts->variables()) {
      const bool traced =
          std::ranges::any_of(stage.facts->traces(), [&](const auto& trace) { return trace.payload == variable.id; });
      if (variable.storage != StorageClass::RayPayloadKHR || !variable.used || traced) continue;
      report.add("Q103", graph.location(stage, variable.declaration),
                 fmt::format("'{}' is a rayPayloadEXT, but no trace of this {} shader uses it; declare the payload of "
                             "the incoming ray as rayPayloadInEXT",
                             variable.name, shader::stageName(stage.kind)),
                 firstTraceOf(graph, stage));
    }
  }
}

}  // namespace

void checkPayloadTypes(const CheckInput& input, Report& report) {
  checkPairs(input.graph, input.graph.traces, StorageClass::IncomingRayPayloadKHR,
             {"Q101", "Q102", "the payload of this trace", "trace"}, report);
  checkQualifiers(input.graph, report);
}

void checkCallableTypes(const CheckInput& input, Report& report) {
  checkPairs(input.graph, input.graph.calls, StorageClass::IncomingCallableDataKHR,
             {"Q301", "Q303", "the data of this call", "call"}, report);
}

}  // namespace quintet::check
