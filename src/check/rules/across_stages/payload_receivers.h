// SPDX-License-Identifier: Apache-2.0
// Stages as receivers of payloads. Thousands of hit shaders of an engine do the same with a payload: they write all of its
// members, read none, and have the same type. The rules about payloads cannot distinguish such stages, so they follow one
// of each class. Diagnostics still name each stage.
#ifndef QUINTET_CHECK_RULES_PAYLOAD_RECEIVERS_H
#define QUINTET_CHECK_RULES_PAYLOAD_RECEIVERS_H

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "check/pipeline_graph.h"

namespace quintet::check {

// A class of stages that agree in all members.
struct PayloadReceiver {
  const spirv::StageFacts* facts = nullptr;         // of one of the stages
  const spirv::SharedVariable* payload = nullptr;   // that it receives; null if none
  std::vector<bool> writes, writesAlways, readsIn;  // by leaf; readsIn: reads before writing
  bool hasEffects = false;                          // memory, traces, calls (shared_data.h)
  bool wrongQualifier = false;  // Q103: it receives nothing, but uses an outgoing payload without a trace
};

class PayloadReceivers {
 public:
  explicit PayloadReceivers(const PipelineGraph& graph);

  const PayloadReceiver& of(std::size_t stage) const { return classes_[classOf_[stage]]; }
  std::size_t classOf(std::size_t stage) const { return classOf_[stage]; }

  // The first of equal edges of a trace, in their order. Edges are equal if they have the same role, are equally exact, and
  // if their stages, and the any-hit stages that run before them, are of the same class and have the same other edges.
  const std::vector<const Edge*>& edges(const TraceSite& site) const { return edges_[site.targets]; }
  // The position in edges() of the first edge that equals edge i of a trace.
  std::size_t kindOf(const TraceSite& site, std::size_t i) const { return kindOf_[site.targets][i]; }
  // The first of equal hits: those without a closest-hit shader or with one, and with equal any-hit stages.
  const std::vector<HitGroupRay>& hits(const TraceSite& site) const { return hits_[site.targets]; }
  // A number that two stages share if they are of the same class and have the same edges.
  std::size_t kindOfStage(std::size_t stage) const { return kindOfStage_[stage]; }

  // True if a trace that can run the stage, other than as an intersection shader, passes the test.
  template <class Test>
  bool anyTraceTo(std::size_t stage, const Test& test) const {
    return std::ranges::any_of(tracesTo_[stage], [&](std::size_t targets) {
      return std::ranges::any_of(graph_.targets[targets].traces, [&](std::size_t i) { return test(graph_.traces[i]); });
    });
  }
  // True if all traces pass the test, which depends only on their arguments.
  template <class Test>
  bool allTraces(const Test& test) const {
    return std::ranges::all_of(graph_.targets,
                               [&](const TraceTargets& t) { return test(graph_.traces[t.traces.front()]); });
  }
  // In their order: the traces that can run the stage, other than as an intersection shader.
  std::vector<const TraceSite*> tracesTo(std::size_t stage) const;

  // By class: whether it receives the type that the trace sends. True if it receives nothing.
  const std::vector<bool>& sameTypes(const TraceSite& site) const;

 private:
  void addClasses(const PipelineGraph& graph);
  void addKinds(const PipelineGraph& graph);
  void addTargets(const PipelineGraph& graph, const TraceTargets& targets);

  const PipelineGraph& graph_;
  std::vector<PayloadReceiver> classes_;
  std::vector<std::size_t> classOf_, kindOfStage_;  // by stage
  std::vector<std::vector<std::size_t>> tracesTo_;  // targets by stage
  std::vector<std::vector<const Edge*>> edges_;     // by targets
  std::vector<std::vector<std::size_t>> kindOf_;
  std::vector<std::vector<HitGroupRay>> hits_;
  mutable std::map<std::string, std::vector<bool>> sameTypes_;  // by the signature of what is sent
};

}  // namespace quintet::check
#endif
