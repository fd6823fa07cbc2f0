// SPDX-License-Identifier: Apache-2.0
// Q304: callable data that is read without being written: by the caller after a call, or by the callable shader.
#include <fmt/format.h>

#include <algorithm>

#include "check/rules/across_stages/shared_data.h"
#include "check/rules/rules.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::StorageClass;

class CallableDataRule {
 public:
  CallableDataRule(const PipelineGraph& graph, Report& report) : graph_(graph), report_(report) {}

  void check(const CallSite& site) {
    site_ = &site;
    caller_ = &graph_.facts(site);
    data_ = caller_->variable(site.call->data);
    if (!data_ || data_->storage != StorageClass::CallableDataKHR) return;
    const std::vector<bool> same =
        sameTypes(graph_, site.edges, *caller_, *data_, StorageClass::IncomingCallableDataKHR);
    targets_.clear();
    bool exact = true;
    for (std::size_t i = 0; i < site.edges.size(); ++i) {
      if (same[i]) targets_.push_back(&site.edges[i]);
      exact = exact && site.edges[i].exact;
      if (site.edges[i].exact && !same[i]) return;  // Q301
    }
    if (targets_.empty()) return;
    each_ = exact || isOnlyCall();
    std::vector<LeafGroup> unwritten, unset;
    for (std::uint32_t leaf = 0; leaf < caller_->leaves(data_->id).count(); ++leaf) {
      findUnwritten(leaf, unwritten);
      findUnset(leaf, unset);
    }
    for (const LeafGroup& group : unwritten) {
      const std::string line = readLine(*caller_, group.read, site.call->location.file);
      for (const std::string& part : caller_->leaves(data_->id).names(group.leaves))
        report_.add("Q304", graph_.location(site), nameOf(*data_, part) + group.text.after + line + group.text.end);
    }
    for (const LeafGroup& group : unset)
      for (const std::string& part : caller_->leaves(data_->id).names(group.leaves))
        report_.add("Q304", graph_.location(site), group.text.before + nameOf(*data_, part) + group.text.after);
  }

  // Data that is read before any call, in the stage that declares it.
  void checkReads(const PipelineStage& stage) {
    const spirv::StageFacts& facts = *stage.facts;
    for (const spirv::SharedVariable& data : facts.variables()) {
      if (data.storage != StorageClass::CallableDataKHR) continue;
      std::vector<LeafGroup> groups;
      for (std::uint32_t leaf = 0; leaf < facts.leaves(data.id).count(); ++leaf)
        for (const std::size_t read : facts.inputReads(data.id, leaf))
          addTo(groups, {"", " is read here, but no store to it and no call with it comes before", ""}, leaf, read);
      for (const LeafGroup& group : groups)
        for (const std::string& part : facts.leaves(data.id).names(group.leaves))
          report_.add("Q304", graph_.location(stage, locationOf(facts, facts.accesses()[group.read])),
                      nameOf(data, part) + group.text.after);
    }
  }

 private:
  // With a dynamic index, a call can reach all callable shaders with its type. If it is the only call with this type, it
  // is meant to reach all of them.
  bool isOnlyCall() const {
    return std::ranges::none_of(graph_.calls, [&](const CallSite& other) {
      if (&other == site_) return false;
      const spirv::SharedVariable* sent = graph_.facts(other).variable(other.call->data);
      return sent &&
             !differenceOf(caller_->module().types(), data_->type, graph_.facts(other).module().types(), sent->type);
    });
  }

  // The first target for which the test holds; null unless it holds for one of those that the call surely reaches.
  template <class Test>
  const Edge* firstTarget(const Test& test) const {
    if (!each_ && !std::ranges::all_of(targets_, test)) return nullptr;
    const auto found = std::ranges::find_if(targets_, test);
    return found == targets_.end() ? nullptr : *found;
  }

  bool anyTargetWrites(std::uint32_t leaf) const {
    return std::ranges::any_of(targets_, [&](const Edge* edge) {
      const spirv::SharedVariable* received = graph_.facts(*edge).incoming(StorageClass::IncomingCallableDataKHR);
      return received && graph_.facts(*edge).writes(received->id, leaf);
    });
  }

  void findUnwritten(std::uint32_t leaf, std::vector<LeafGroup>& groups) const {
    const std::size_t call = site_->call->instruction;
    std::vector<std::size_t> reads = caller_->unguardedReads(call, data_->id, leaf);
    std::erase_if(reads, [&](std::size_t i) { return !caller_->accesses()[i].leaves.exact; });
    if (reads.empty() || caller_->writtenBefore(data_->id, leaf, call)) return;
    const Edge* target = firstTarget([&](const Edge* edge) {
      const spirv::SharedVariable* received = graph_.facts(*edge).incoming(StorageClass::IncomingCallableDataKHR);
      if (!received) return true;
      return edge->exact ? !graph_.facts(*edge).writesAlways(received->id, leaf)
                         : !graph_.facts(*edge).writes(received->id, leaf);
    });
    if (!target) return;
    const spirv::SharedVariable* received = graph_.facts(*target).incoming(StorageClass::IncomingCallableDataKHR);
    const bool somePath = received && graph_.facts(*target).writes(received->id, leaf);
    addTo(groups,
          {"", " is read after this call",
           fmt::format(", but the {}{} does not write it, and it is not set before the call", graph_.describe(*target),
                       somePath ? ", on some path," : "")},
          leaf, reads.front());
  }

  void findUnset(std::uint32_t leaf, std::vector<LeafGroup>& groups) const {
    const std::size_t call = site_->call->instruction;
    const spirv::Module& module = caller_->module();
    // In a loop, the call itself comes before its next one. It sets only what its shaders write.
    for (const std::size_t writer : caller_->writers(data_->id, leaf))
      if (spirv::canRunAfter(module, call, writer) && (writer != call || anyTargetWrites(leaf))) return;
    std::size_t read = 0;
    const Edge* target = firstTarget([&](const Edge* edge) {
      const spirv::StageFacts& facts = graph_.facts(*edge);
      const spirv::SharedVariable* received = facts.incoming(StorageClass::IncomingCallableDataKHR);
      const std::vector<std::size_t> reads =
          received ? facts.inputReads(received->id, leaf) : std::vector<std::size_t>{};
      if (!reads.empty()) read = reads.front();
      return !reads.empty();
    });
    if (!target) return;
    const spirv::StageFacts& facts = graph_.facts(*target);
    const SourceLocation location = locationOf(facts, facts.accesses()[read]);
    addTo(groups,
          {fmt::format("the {} reads ", graph_.describe(*target)),
           fmt::format(" ({}:{}), but it is not set before this call", location.file, location.line), ""},
          leaf, 0);
  }

  const PipelineGraph& graph_;
  Report& report_;
  const CallSite* site_ = nullptr;  // the call that is checked
  const spirv::StageFacts* caller_ = nullptr;
  const spirv::SharedVariable* data_ = nullptr;
  std::vector<const Edge*> targets_;  // with the type of the data
  bool each_ = true;                  // the call can reach each target
};

}  // namespace

void checkCallableData(const CheckInput& input, Report& report) {
  CallableDataRule rule(input.graph, report);
  for (const CallSite& site : input.graph.calls) rule.check(site);
  for (const PipelineStage& stage : input.graph.stages)
    if (stage.facts) rule.checkReads(stage);
}

}  // namespace quintet::check
