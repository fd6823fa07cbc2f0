// Q101 payload types, Q102 locations, Q103 the wrong qualifier.
#include <fmt/format.h>

#include <algorithm>

#include "program/check_parts.h"

namespace quintet::program {
namespace {

using shader::SharedVariable;
using shader::StageFacts;
using spv::StorageClass;

std::optional<std::string> difference(const StageFacts& a, const SharedVariable& left, const StageFacts& b,
                                      const SharedVariable& right) {
  return shader::differenceOf(a.module().types(), left.type, b.module().types(), right.type);
}

// Where arguments are not constant, a trace or a call is assumed to reach more than it does. A pair that differs then
// counts only if the one side fits nobody: every pair of it differs.
struct Pair {
  std::size_t site = 0;  // in the list of sites
  const Edge* edge = nullptr;
  std::optional<std::string> difference;
};

bool countsAsError(const std::vector<Pair>& pairs, const Pair& pair) {
  if (!pair.difference) return false;
  if (pair.edge->exact) return true;
  const auto fits = [&](auto same) {
    return std::ranges::any_of(pairs, [&](const Pair& p) { return !p.difference && same(p); });
  };
  const bool calleeFits = fits([&](const Pair& p) { return p.edge->stage == pair.edge->stage; });
  const bool siteFits = fits([&](const Pair& p) {
    return p.site == pair.site && (p.edge->role == Role::miss) == (pair.edge->role == Role::miss);
  });
  return !calleeFits || !siteFits;
}

// A stage that is called itself cannot send at the location where it receives: then another one is no mistake.
bool locationsDiffer(const StageFacts& sender, const SharedVariable& sent, const SharedVariable& received) {
  if (!sent.location || !received.location || sent.location == received.location) return false;
  const SharedVariable* own = sender.incoming(received.storage);
  return !own || own->location != received.location;
}

void checkQualifiers(const LinkModel& model, Report& report) {
  for (const LinkStage& stage : model.stages) {
    const bool called = stage.kind == shader::Stage::closestHit || stage.kind == shader::Stage::miss ||
                        stage.kind == shader::Stage::anyHit;
    if (!called || !stage.facts) continue;
    for (const SharedVariable& variable : stage.facts->variables()) {
      const bool traced =
          std::ranges::any_of(stage.facts->traces(), [&](const auto& trace) { return trace.payload == variable.id; });
      if (variable.storage != StorageClass::RayPayloadKHR || !variable.used || traced) continue;
      report.add("Q103", model.at(stage, variable.place),
                 fmt::format("'{}' is a rayPayloadEXT that no trace of this {} shader uses: to see the payload of the "
                             "ray that runs it, "
                             "declare it rayPayloadInEXT",
                             variable.name, shader::stageName(stage.kind)));
    }
  }
}

}  // namespace

void checkPayloads(const CheckInput& input, Report& report) {
  const LinkModel& model = input.model;
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < model.traces.size(); ++i) {
    const TraceSite& site = model.traces[i];
    const StageFacts& tracer = *model.stages[site.stage].facts;
    const SharedVariable* sent = tracer.variable(site.trace->payload);
    for (const Edge& edge : site.edges) {
      const StageFacts& callee = *model.stages[edge.stage].facts;
      const SharedVariable* received =
          edge.role == Role::intersection ? nullptr : callee.incoming(StorageClass::IncomingRayPayloadKHR);
      if (sent && received) pairs.push_back({i, &edge, difference(tracer, *sent, callee, *received)});
    }
  }
  for (const Pair& pair : pairs) {
    const TraceSite& site = model.traces[pair.site];
    const StageFacts& tracer = *model.stages[site.stage].facts;
    const SharedVariable& sent = *tracer.variable(site.trace->payload);
    const StageFacts& callee = *model.stages[pair.edge->stage].facts;
    const SharedVariable& received = *callee.incoming(StorageClass::IncomingRayPayloadKHR);
    const shader::Place place = model.at(model.stages[site.stage], site.trace->place);
    if (countsAsError(pairs, pair)) {
      report.add("Q101", place,
                 fmt::format("the payload of this trace is {}; the {} that it reaches has {}: {}",
                             tracer.module().types().describe(sent.type), model.describe(*pair.edge),
                             callee.module().types().describe(received.type), *pair.difference));
    } else if (!pair.difference && pair.edge->exact && locationsDiffer(tracer, sent, received)) {
      report.add("Q102", model.at(model.stages[pair.edge->stage], received.place),
                 fmt::format("'{}' is at location {} here; the trace at {}:{} that runs this shader sends location {}",
                             received.name, *received.location, place.file, place.line, *sent.location));
    }
  }
  checkQualifiers(model, report);
}

void checkCallables(const CheckInput& input, Report& report) {
  const LinkModel& model = input.model;
  const std::size_t count = model.program.callables.size();
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < model.calls.size(); ++i) {
    const CallSite& site = model.calls[i];
    const StageFacts& caller = *model.stages[site.stage].facts;
    const shader::Place place = model.at(model.stages[site.stage], site.call->place);
    for (const std::uint32_t index : site.call->index.values)
      if (index >= count)
        report.add("Q302", place,
                   fmt::format("this calls callable shader {}, but the program has {}", index,
                               count == 0 ? "none" : fmt::format("{}: 0 to {}", count, count - 1)));
    if (!site.call->index.known && count == 0)
      report.add("Q302", place, "this calls a callable shader, but the program has none");
    const SharedVariable* sent = caller.variable(site.call->data);
    for (const Edge& edge : site.edges) {
      const StageFacts& callee = *model.stages[edge.stage].facts;
      const SharedVariable* received = callee.incoming(StorageClass::IncomingCallableDataKHR);
      if (sent && received) pairs.push_back({i, &edge, difference(caller, *sent, callee, *received)});
    }
  }
  for (const Pair& pair : pairs) {
    const CallSite& site = model.calls[pair.site];
    const StageFacts& caller = *model.stages[site.stage].facts;
    const SharedVariable& sent = *caller.variable(site.call->data);
    const StageFacts& callee = *model.stages[pair.edge->stage].facts;
    const SharedVariable& received = *callee.incoming(StorageClass::IncomingCallableDataKHR);
    const shader::Place place = model.at(model.stages[site.stage], site.call->place);
    if (countsAsError(pairs, pair)) {
      report.add("Q301", place,
                 fmt::format("the data of this call is {}; the {} that it reaches has {}: {}",
                             caller.module().types().describe(sent.type), model.describe(*pair.edge),
                             callee.module().types().describe(received.type), *pair.difference));
    } else if (!pair.difference && pair.edge->exact && locationsDiffer(caller, sent, received)) {
      report.add("Q303", model.at(model.stages[pair.edge->stage], received.place),
                 fmt::format("'{}' is at location {} here; the call at {}:{} sends location {}", received.name,
                             *received.location, place.file, place.line, *sent.location));
    }
  }
}

}  // namespace quintet::program
