// SPDX-License-Identifier: Apache-2.0
// What a ray tracing stage shares with other stages: its traces, callable calls and intersection reports, and its
// accesses to payloads, hit attributes and callable data by member. check/pipeline_graph.h connects the stages.
//
// Approximations: members are those of the outermost structure, and a part of a member counts as the member. An access
// with a dynamic outermost index, or through a pointer that is passed to a function that was not inlined, counts for
// all members.
#ifndef QUINTET_SPIRV_STAGE_FACTS_H
#define QUINTET_SPIRV_STAGE_FACTS_H

#include "spirv/control_flow.h"
#include "spirv/module.h"
#include "spirv/value_range.h"

namespace quintet::spirv {

// The values that an argument can have.
struct ArgumentValues {
  bool known = false;                 // false if `values` is empty because they are not known
  std::vector<std::uint32_t> values;  // all values, sorted
  bool each = true;                   // each of them occurs; false if some need not
  std::uint32_t min = 0;              // a lower bound, also if the values are not known
  std::uint32_t ones = 0, zeros = 0;  // bits that are always set, never set

  bool exact() const { return known && values.size() == 1; }
  bool certain() const { return known && each; }  // not only an estimate
  // A value of at least `count` that certainly occurs; nullopt if there may be none.
  std::optional<std::uint32_t> atLeast(std::uint32_t count) const;
  bool mayHave(std::uint32_t bits) const;   // one of the bits can be set
  bool mustHave(std::uint32_t bits) const;  // all bits are set in each value
};

// A traceRayEXT.
struct TraceFacts {
  std::size_t instruction = 0;
  SourceLocation location;
  Id payload = 0;  // the variable
  ArgumentValues flags, mask, offset, stride, miss;
  bool inLoop = false;
};

// An executeCallableEXT.
struct CallFacts {
  std::size_t instruction = 0;
  SourceLocation location;
  Id data = 0;  // the variable
  ArgumentValues index;
};

// A reportIntersectionEXT.
struct ReportFacts {
  std::size_t instruction = 0;
  SourceLocation location;
  ArgumentValues hitKind;
};

constexpr std::uint32_t kWholeValue = ~0u;  // all members

// One read or write of a variable that stages share.
struct AccessFacts {
  std::size_t instruction = 0;
  Id variable = 0;
  std::uint32_t member = kWholeValue;  // of a structure; 0 for any other type
  Id value = 0;                        // of a read: the id with the member's value; 0 if unknown
  bool reads = false;
  bool writes = false;
};

struct BuiltInRead {
  spv::BuiltIn builtIn = spv::BuiltIn::Max;
  std::size_t instruction = 0;
  SourceLocation location;
  bool afterTrace = false;  // can run after a trace of the same stage
};

// A payload, hit attribute or callable data variable.
struct SharedVariable {
  Id id = 0;
  spv::StorageClass storage = spv::StorageClass::Max;
  Id type = 0;
  std::string name;
  SourceLocation declaration;   // unknown if the source does not have it
  std::optional<int> location;  // layout location from the source, since SPIR-V does not have it
  bool used = false;            // read or written, or argument of a trace, call or report
};

// Not thread-safe: some results are cached.
class StageFacts {
 public:
  // `context`: what is known about values in any scene.
  explicit StageFacts(Module module, ValueContext context = {});
  StageFacts(StageFacts&&) noexcept = default;

  const Module& module() const { return module_; }
  const ValueRanges& ranges() const { return ranges_; }
  const std::vector<TraceFacts>& traces() const { return traces_; }
  const std::vector<CallFacts>& calls() const { return calls_; }
  const std::vector<ReportFacts>& reports() const { return reports_; }
  const std::vector<AccessFacts>& accesses() const { return accesses_; }
  const std::vector<BuiltInRead>& builtIns() const { return builtIns_; }
  const std::vector<SharedVariable>& variables() const { return variables_; }
  bool ignores() const { return ignores_; }        // has ignoreIntersectionEXT
  bool terminates() const { return terminates_; }  // has terminateRayEXT

  // The used variable of a storage class that a stage has at most once (incoming payload, hit attribute, incoming
  // callable data); null if the stage uses none.
  const SharedVariable* incoming(spv::StorageClass storage) const;
  const SharedVariable* variable(Id id) const;
  const ControlFlow& flow(std::size_t function) const { return flows_[function]; }

  std::uint32_t memberCount(Id variable) const;  // 1 for types other than structures
  // True if the stage writes the member on each path to its end. The body of a loop counts as executed.
  bool writesAlways(Id variable, std::uint32_t member) const;
  bool writes(Id variable, std::uint32_t member) const;
  bool reads(Id variable, std::uint32_t member) const;
  // True if the stage reads the member on a path where it has not written it: the caller's value is an input.
  bool readsBeforeWriting(Id variable, std::uint32_t member) const;
  // True if the member is written on each path from the stage's start to the instruction. Another trace or call with
  // the variable counts as a write.
  bool writtenBefore(Id variable, std::uint32_t member, std::size_t instruction) const;

  // Indices into accesses() of the reads of a member that see the result of `trace` on a path that no condition on the
  // payload guards. `if (payload.hit) use(payload.color)` is a guarded read of `color`.
  std::vector<std::size_t> unguardedReads(const TraceFacts& trace, std::uint32_t member) const;
  // The same with guarded reads.
  std::vector<std::size_t> readsAfter(const TraceFacts& trace, std::uint32_t member) const;

  // Bytes of the variables in the stage's stack frame: its outgoing payloads and callable data, and hit attributes.
  std::uint64_t frameBytes() const;

 private:
  void readInstruction(std::size_t index);
  void addAccess(std::size_t index, Id pointer, bool reads, bool writes);
  void addWholeLoad(std::size_t index, Id variable);
  void addWholeStore(std::size_t index, Id variable, Id value);
  void markUsed();
  ArgumentValues values(std::size_t index, Id id) const;

  std::vector<std::size_t> writers(Id variable, std::uint32_t member) const;
  std::vector<std::size_t> readsAfter(const PathsAfter& paths, const TraceFacts& trace, std::uint32_t member) const;
  bool runsAlwaysBefore(std::vector<std::size_t> marks, std::size_t instruction) const;
  bool dependsOnPayload(Id value, Id payload) const;
  bool guarded(const PathsAfter& paths, std::size_t instruction, Id payload) const;
  bool usedUnguarded(const PathsAfter& paths, const AccessFacts& read) const;
  bool choosesByPayload(const Instruction& use, Id value, const AccessFacts& read) const;

  Module module_;
  ValueRanges ranges_;
  std::vector<ControlFlow> flows_;
  std::vector<TraceFacts> traces_;
  std::vector<CallFacts> calls_;
  std::vector<ReportFacts> reports_;
  std::vector<AccessFacts> accesses_;
  std::vector<BuiltInRead> builtIns_;
  std::vector<SharedVariable> variables_;
  bool ignores_ = false;
  bool terminates_ = false;
  mutable std::map<std::pair<Id, Id>, bool> dependsOnPayload_;  // cache, by value and payload
};

}  // namespace quintet::spirv
#endif
