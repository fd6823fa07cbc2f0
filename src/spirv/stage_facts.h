// SPDX-License-Identifier: Apache-2.0
// What a ray tracing stage shares with other stages: its traces, callable calls and intersection reports, and its
// accesses to payloads, hit attributes and callable data by leaf (leaves.h). check/pipeline_graph.h connects the stages.
//
// Approximations: an access with a dynamic index counts for all elements, and an access through a pointer that is passed
// to a function that was not inlined counts for all leaves.
#ifndef QUINTET_SPIRV_STAGE_FACTS_H
#define QUINTET_SPIRV_STAGE_FACTS_H

#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <unordered_map>

#include "spirv/control_flow.h"
#include "spirv/leaves.h"
#include "spirv/module.h"
#include "spirv/value_part.h"
#include "spirv/value_ranges.h"

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
  bool mayBe(std::uint32_t value) const;    // as far as the bound and the bits say
  bool mayHave(std::uint32_t bits) const;   // one of the bits can be set
  bool mustHave(std::uint32_t bits) const;  // all bits are set in each value

  auto operator<=>(const ArgumentValues&) const = default;
};

// What a trace does. Hit objects (trace_instruction.h) separate the search for the hit from the shader at its end.
enum class TracePart : std::uint8_t {
  whole,     // traceRayEXT
  search,    // hitObjectTraceRay: only intersection and any-hit shaders run
  execution  // hitObjectExecuteShader: only the closest-hit or miss shader runs
};

// A trace of a ray, or a part of it.
struct TraceFacts {
  std::size_t instruction = 0;
  SourceLocation location;
  Id payload = 0;                                    // the variable
  ArgumentValues flags, mask, offset, stride, miss;  // of an execution: those of what filled the hit object
  bool inLoop = false;
  TracePart part = TracePart::whole;
  std::size_t ray = Module::kNone;     // the instruction with the arguments of the ray; kNone if it is not known
  bool mayHit = true, mayMiss = true;  // an execution: whether the hit object can be one
  // An execution: each hit or miss that may be executed is. False if which ones are is unknown; it can be none.
  bool runsAll = true;
  bool missRuns = true;  // a search: whether its miss is certainly executed
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

// One read or write of leaves of a variable that stages share.
struct AccessFacts {
  std::size_t instruction = 0;
  Id variable = 0;
  LeafRange leaves;
  Id value = 0;  // of a read: the id with the value of the leaves; 0 if unknown
  bool reads = false;
  bool writes = false;
  bool separateParts = false;  // of a read: extracted parts of `value`, and stores to the variable, are other accesses
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

// A condition on a variable that decides whether a value is used: `payload.hit` in `if (payload.hit) use(payload.color)`.
struct Guard {
  Id condition = 0;
  std::optional<bool> holds;  // the value with which the value is used; nullopt if both are possible
};
// Returns false for a guard to ignore.
using GuardTest = std::function<bool(const Guard&)>;

// Not thread-safe: some results are cached.
class StageFacts {
 public:
  // `context`: what is known about values in any scene.
  explicit StageFacts(Module module, ValueContext context = {});
  StageFacts(const StageFacts&) = delete;  // the members refer to the module

  const Module& module() const { return module_; }
  const ValueRanges& ranges() const { return ranges_; }
  const std::vector<TraceFacts>& traces() const { return traces_; }
  const std::vector<CallFacts>& calls() const { return calls_; }
  const std::vector<ReportFacts>& reports() const { return reports_; }
  const std::vector<AccessFacts>& accesses() const { return accesses_; }
  const std::vector<BuiltInRead>& builtIns() const { return builtIns_; }
  const std::vector<SharedVariable>& variables() const { return variables_; }
  bool ignores() const { return ignores_; }  // has ignoreIntersectionEXT
  bool hasUnknownConstants() const;          // has specialization constants without a value

  // The used variable of a storage class that a stage has at most once (incoming payload, hit attribute, incoming
  // callable data); null if the stage uses none.
  const SharedVariable* incoming(spv::StorageClass storage) const;
  const SharedVariable* variable(Id id) const;
  const ControlFlow& flow(std::size_t function) const { return flows_[function]; }

  const Leaves& leaves(Id variable) const;  // of its type; none if the variable is unknown

  // True if the stage writes the leaf on each path to its end. The body of a loop counts as executed.
  bool writesAlways(Id variable, std::uint32_t leaf) const;
  bool writes(Id variable, std::uint32_t leaf) const;
  bool reads(Id variable, std::uint32_t leaf) const;
  // True if the stage reads the leaf on a path where it has not written it: the caller's value is an input.
  bool readsBeforeWriting(Id variable, std::uint32_t leaf) const;
  // Indices into accesses() of the reads that have an effect although no write of the stage has run before them. Skips reads
  // whose condition cannot be evaluated for the first iteration of a loop.
  std::vector<std::size_t> inputReads(Id variable, std::uint32_t leaf) const;
  // True if the leaf is written on each path from the stage's start to the instruction. Another trace or call with the
  // variable counts as a write, except a search, in which only any-hit shaders write.
  bool writtenBefore(Id variable, std::uint32_t leaf, std::size_t instruction) const;
  // Instructions that write the leaf, including traces and calls with the variable.
  std::vector<std::size_t> writers(Id variable, std::uint32_t leaf) const;
  // The part of a value that a write stores to the leaf; id 0 if unknown.
  ValuePart storedValue(const AccessFacts& write, std::uint32_t leaf) const;

  // Indices into accesses() of the reads of a leaf that see the result of a trace or call with the variable on a path
  // that no condition on the variable guards. `if (payload.hit) use(payload.color)` is a guarded read of `color`. Conditions on
  // hit objects guard, too. With a test, conditions for which it fails do not guard.
  std::vector<std::size_t> unguardedReads(std::size_t site, Id variable, std::uint32_t leaf,
                                          const GuardTest& test = {}) const;
  // The same with guarded reads.
  std::vector<std::size_t> readsAfter(std::size_t site, Id variable, std::uint32_t leaf) const;
  const PathsAfter& pathsAfter(std::size_t instruction) const;  // of an instruction inside a function; cached
  // True if the value depends on a load of the variable, or on a hit object that is traced or executed with it, through data or
  // control.
  bool dependsOnVariable(Id value, Id variable) const;
  // True if the value depends on a read of the leaf.
  bool dependsOnLeaf(Id value, Id variable, std::uint32_t leaf) const;

  // Bytes of the variables in the stage's stack frame: its outgoing payloads and callable data, and hit attributes.
  std::uint64_t frameBytes() const;

 private:
  void readInstruction(std::size_t index);
  void addTrace(std::size_t index);
  void findExecuted();
  void describeExecution(TraceFacts& execution);
  const TraceFacts* traceAt(std::size_t instruction) const;
  void addAccess(std::size_t index, Id pointer, bool reads, bool writes);
  void addLoad(std::size_t index, Id variable, const Path& path, Id value);
  void addStore(std::size_t index, Id variable, const Access& target, LeafRange range, Id value);
  bool onlyStoredTo(Id variable, const Instruction& use) const;
  void markUsed();
  ArgumentValues values(std::size_t index, Id id) const;

  bool runsAlwaysBefore(std::vector<std::size_t> marks, std::size_t instruction) const;
  bool runsInFirstIteration(std::size_t instruction) const;
  Guard guardOf(const PathsAfter& paths, std::size_t block, std::size_t instruction) const;
  bool guarded(const PathsAfter& paths, std::size_t instruction, Id variable, const GuardTest& test) const;
  bool arrivesGuarded(const PathsAfter& paths, const Instruction& phi, Id value, Id variable,
                      const GuardTest& test) const;
  bool usedUnguarded(const PathsAfter& paths, const AccessFacts& read, std::uint32_t leaf, const GuardTest& test) const;
  bool queriesObjectOf(const Instruction& query, Id variable) const;
  bool branchesAfter(const PathsAfter& paths, Id condition, Id variable) const;
  bool choosesByVariable(const PathsAfter& paths, const Instruction& use, Id value, const AccessFacts& read,
                         std::uint32_t leaf, const GuardTest& test) const;
  bool isOwnAccess(const Instruction& use, Id value, const AccessFacts& read) const;

  Module module_;
  ValueRanges ranges_;
  std::vector<ControlFlow> flows_;
  std::vector<TraceFacts> traces_;
  std::vector<CallFacts> calls_;
  std::vector<ReportFacts> reports_;
  std::vector<AccessFacts> accesses_;
  std::vector<BuiltInRead> builtIns_;
  std::vector<SharedVariable> variables_;  // by location, then in the order of declaration
  bool ignores_ = false;
  std::unordered_map<Id, std::vector<std::size_t>> reads_;             // indices into accesses_, by value
  std::map<Id, Leaves> leaves_;                                        // by variable
  std::vector<std::pair<std::size_t, std::size_t>> loops_;             // header and merge block, of the entry function
  mutable std::map<std::pair<Id, Id>, bool> dependsOnVariable_;        // cache, by value and variable
  std::map<Id, std::vector<Id>> hitObjects_;                           // by payload
  mutable std::map<std::size_t, std::unique_ptr<PathsAfter>> paths_;   // cache, by instruction
  mutable std::map<std::pair<Id, std::uint32_t>, bool> writesAlways_;  // cache, by variable and leaf
  mutable std::map<std::pair<Id, std::uint32_t>, bool> readsBeforeWriting_;
};

}  // namespace quintet::spirv
#endif
