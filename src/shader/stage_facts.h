// What a ray tracing stage does that other stages see: its traces, calls and reports, and how it uses payloads, hit
// attributes and callable data, member by member. Read off the module; the link (program/check.h) joins the stages.
//
// Approximations. Members are those of the outermost structure; a part of a member counts as the member. An access
// with a dynamic outermost index, or through a pointer that is handed to a function which was not inlined, counts for
// every member.
#ifndef QUINTET_SHADER_STAGE_FACTS_H
#define QUINTET_SHADER_STAGE_FACTS_H

#include "shader/control_flow.h"
#include "shader/spirv_module.h"

namespace quintet::shader {

// The values that an argument can have. Unknown: any.
struct ArgumentValues {
  bool known = false;
  std::vector<std::uint32_t> values;  // sorted

  bool exact() const { return known && values.size() == 1; }
  bool may(std::uint32_t bits) const;   // can one of the bits be set?
  bool must(std::uint32_t bits) const;  // are all bits set in every value?
};

struct TraceFacts {
  std::size_t instruction = 0;
  Place place;
  SpirvId payload = 0;  // the variable
  ArgumentValues flags, mask, offset, stride, miss;
  bool inLoop = false;
};

struct CallFacts {
  std::size_t instruction = 0;
  Place place;
  SpirvId data = 0;  // the variable
  ArgumentValues index;
};

struct ReportFacts {
  std::size_t instruction = 0;
  Place place;
  ArgumentValues hitKind;
};

constexpr std::uint32_t kWholeValue = ~0u;  // every member

// One read or write of a variable that stages share.
struct AccessFacts {
  std::size_t instruction = 0;
  SpirvId variable = 0;
  std::uint32_t member = kWholeValue;  // of a structure; 0 for any other type
  SpirvId value = 0;                   // of a read: the id that has the member's value; 0: unknown
  bool reads = false;
  bool writes = false;
};

struct BuiltInRead {
  spv::BuiltIn builtIn = spv::BuiltIn::Max;
  std::size_t instruction = 0;
  Place place;
  bool afterTrace = false;  // may run after a trace of the same stage
};

// A variable of a payload, hit attribute or callable data.
struct SharedVariable {
  SpirvId id = 0;
  spv::StorageClass storage = spv::StorageClass::Max;
  SpirvId type = 0;
  std::string name;
  Place place;                  // of its declaration, if it was found in the source
  std::optional<int> location;  // as written in the source: SPIR-V does not have it
  bool used = false;            // read or written, or named by a trace, call or report
};

// Not for two threads at once: some answers are kept.
class StageFacts {
 public:
  explicit StageFacts(SpirvModule module);
  StageFacts(StageFacts&&) noexcept = default;

  const SpirvModule& module() const { return module_; }
  const std::vector<TraceFacts>& traces() const { return traces_; }
  const std::vector<CallFacts>& calls() const { return calls_; }
  const std::vector<ReportFacts>& reports() const { return reports_; }
  const std::vector<AccessFacts>& accesses() const { return accesses_; }
  const std::vector<BuiltInRead>& builtIns() const { return builtIns_; }
  const std::vector<SharedVariable>& variables() const { return variables_; }
  bool ignores() const { return ignores_; }        // has ignoreIntersectionEXT
  bool terminates() const { return terminates_; }  // has terminateRayEXT

  // The one variable of a storage class that stages have once (incoming payload, hit attribute, incoming callable
  // data); null: none that is used.
  const SharedVariable* incoming(spv::StorageClass storage) const;
  const SharedVariable* variable(SpirvId id) const;
  const ControlFlow& flow(std::size_t function) const { return flows_[function]; }

  std::uint32_t memberCount(SpirvId variable) const;  // 1 for what is no structure
  // Does the stage write the member on every path to its end? A loop's body counts as run.
  bool writesAlways(SpirvId variable, std::uint32_t member) const;
  bool writes(SpirvId variable, std::uint32_t member) const;
  bool reads(SpirvId variable, std::uint32_t member) const;
  // Is it read on a path where the stage has not written it: is what the caller put there an input?
  bool takes(SpirvId variable, std::uint32_t member) const;
  // Is the member written on every path from the stage's start to the instruction? Another trace or call with the
  // variable counts as a write.
  bool writtenBefore(SpirvId variable, std::uint32_t member, std::size_t instruction) const;

  // Reads of a member whose value is what `trace` left there, on a path that no condition on the payload guards:
  // `if (payload.hit) use(payload.color)` is no such read of `color`.
  std::vector<std::size_t> unguardedReads(const TraceFacts& trace, std::uint32_t member) const;
  // The same, guarded or not.
  std::vector<std::size_t> readsAfter(const TraceFacts& trace, std::uint32_t member) const;

  // Bytes of the variables that the stage keeps in its frame: payloads and callable data of its own, hit attributes.
  std::uint64_t frameBytes() const;

 private:
  void readInstruction(std::size_t index);
  void addAccess(std::size_t index, SpirvId pointer, bool reads, bool writes);
  void addWholeLoad(std::size_t index, SpirvId variable);
  void addWholeStore(std::size_t index, SpirvId variable, SpirvId value);
  void markUsed();
  ArgumentValues values(SpirvId id) const;

  std::vector<std::size_t> writers(SpirvId variable, std::uint32_t member) const;
  std::vector<std::size_t> readsAfter(const PathsAfter& paths, const TraceFacts& trace, std::uint32_t member) const;
  bool runsAlwaysBefore(std::vector<std::size_t> marks, std::size_t instruction) const;
  bool dependsOnPayload(SpirvId value, SpirvId payload) const;
  bool guarded(const PathsAfter& paths, std::size_t instruction, SpirvId payload) const;
  bool usedUnguarded(const PathsAfter& paths, const AccessFacts& read) const;
  bool choosesByPayload(const SpirvInstruction& use, SpirvId value, const AccessFacts& read) const;

  SpirvModule module_;
  std::vector<ControlFlow> flows_;
  std::vector<TraceFacts> traces_;
  std::vector<CallFacts> calls_;
  std::vector<ReportFacts> reports_;
  std::vector<AccessFacts> accesses_;
  std::vector<BuiltInRead> builtIns_;
  std::vector<SharedVariable> variables_;
  bool ignores_ = false;
  bool terminates_ = false;
  mutable std::map<std::pair<SpirvId, SpirvId>, bool> dependsOnPayload_;  // by value and payload, found on demand
};

}  // namespace quintet::shader
#endif
