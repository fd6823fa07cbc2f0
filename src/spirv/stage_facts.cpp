// SPDX-License-Identifier: Apache-2.0
#include "spirv/stage_facts.h"

#include <algorithm>
#include <unordered_set>

#include "spirv/glsl_declaration.h"
#include "spirv/value_flow.h"

namespace quintet::spirv {
namespace {

using spv::Op;
using spv::StorageClass;
using Indices = std::vector<std::size_t>;
constexpr std::size_t kNone = Module::kNone;

// Returns the GLSL qualifier of a storage class; empty if stages do not share it.
std::string_view keywordOf(StorageClass storage) {
  switch (storage) {
    case StorageClass::RayPayloadKHR: return "rayPayloadEXT";
    case StorageClass::IncomingRayPayloadKHR: return "rayPayloadInEXT";
    case StorageClass::HitAttributeKHR: return "hitAttributeEXT";
    case StorageClass::CallableDataKHR: return "callableDataEXT";
    case StorageClass::IncomingCallableDataKHR: return "callableDataInEXT";
    default: return {};
  }
}

SharedVariable sharedVariable(const Module& module, const Variable& variable) {
  SharedVariable result{variable.id, variable.storage, variable.type, variable.name, {}, {}, false};
  for (const auto& [file, text] : module.sources()) {
    const auto found = findDeclaration(text, keywordOf(variable.storage), variable.name);
    if (!found) continue;
    result.declaration = {found->file.empty() ? file : found->file, found->line, found->column};
    result.location = found->location;
    break;
  }
  return result;
}

// Returns the header and the merge block of each loop of a function.
std::vector<std::pair<std::size_t, std::size_t>> loops(const Module& module, const Function& function) {
  std::vector<std::pair<std::size_t, std::size_t>> result;
  for (std::size_t b = 0; b < function.blocks.size(); ++b) {
    const Block& block = function.blocks[b];
    if (block.end - block.first < 2) continue;
    const Instruction& merge = module.instructions()[block.end - 2];
    if (merge.op != Op::OpLoopMerge) continue;
    const auto found = std::ranges::find(function.blocks, merge.at(0), &Block::label);
    if (found != function.blocks.end())
      result.push_back({b, static_cast<std::size_t>(found - function.blocks.begin())});
  }
  return result;
}

bool hasEffect(Op op) {
  switch (op) {
    case Op::OpStore:
    case Op::OpTraceRayKHR:
    case Op::OpExecuteCallableKHR:
    case Op::OpReportIntersectionKHR:
    case Op::OpFunctionCall:
    case Op::OpImageWrite:
    case Op::OpCopyMemory:
    case Op::OpBranchConditional:
    case Op::OpSwitch:
    case Op::OpReturnValue:
    case Op::OpAtomicStore:
    case Op::OpAtomicExchange:
    case Op::OpAtomicIAdd:
    case Op::OpAtomicISub:
    case Op::OpAtomicSMin:
    case Op::OpAtomicUMin:
    case Op::OpAtomicSMax:
    case Op::OpAtomicUMax:
    case Op::OpAtomicAnd:
    case Op::OpAtomicOr:
    case Op::OpAtomicXor:
    case Op::OpAtomicCompareExchange: return true;
    default: return false;
  }
}

}  // namespace

bool ArgumentValues::mayHave(std::uint32_t bits) const {
  if (!known) return (~zeros & bits) != 0;
  return std::ranges::any_of(values, [&](std::uint32_t value) { return (value & bits) != 0; });
}

bool ArgumentValues::mustHave(std::uint32_t bits) const {
  if (!known) return bits != 0 && (ones & bits) == bits;
  return std::ranges::all_of(values, [&](std::uint32_t value) { return (value & bits) == bits; });
}

std::optional<std::uint32_t> ArgumentValues::atLeast(std::uint32_t count) const {
  if (min >= count) return min;
  if (!certain()) return {};
  const auto found = std::ranges::lower_bound(values, count);
  return found == values.end() ? std::nullopt : std::optional(*found);
}

StageFacts::StageFacts(Module module, ValueContext context)
    : module_(std::move(module)), ranges_(module_, std::move(context)) {
  for (std::size_t i = 0; i < module_.functions().size(); ++i) flows_.emplace_back(module_, i);
  for (const Variable& variable : module_.variables())
    if (!keywordOf(variable.storage).empty()) variables_.push_back(sharedVariable(module_, variable));
  for (std::size_t i = 0; i < module_.instructions().size(); ++i)
    if (const auto position = module_.position(i); position && flows_[position->function].reachable(position->block))
      readInstruction(i);
  for (BuiltInRead& read : builtIns_)
    read.afterTrace = std::ranges::any_of(
        traces_, [&](const TraceFacts& trace) { return canRunAfter(module_, read.instruction, trace.instruction); });
  markUsed();
}

void StageFacts::markUsed() {
  const auto mark = [&](Id id) {
    for (SharedVariable& variable : variables_)
      if (variable.id == id) variable.used = true;
  };
  for (const AccessFacts& access : accesses_) mark(access.variable);
  for (const TraceFacts& trace : traces_) mark(trace.payload);
  for (const CallFacts& call : calls_) mark(call.data);
}

ArgumentValues StageFacts::values(std::size_t index, Id id) const {
  ArgumentValues result;
  if (auto found = module_.possibleValues(id)) {
    result.values = std::move(*found);
  } else {
    const ValueRange range = ranges_.rangeAt(index, id);
    if (range.empty()) return result;
    for (const double value : range.values) result.values.push_back(static_cast<std::uint32_t>(std::int64_t(value)));
    std::ranges::sort(result.values);
    result.each = range.occurrence == Occurrence::each && !ranges_.guarded(index, id);
    result.ones = range.ones, result.zeros = range.zeros;
    if (range.min >= 0.0 && range.min <= 4294967295.0) result.min = static_cast<std::uint32_t>(range.min);
  }
  result.known = !result.values.empty();
  if (result.known) result.min = result.values.front();
  return result;
}

void StageFacts::readInstruction(std::size_t index) {
  const Instruction& i = module_.instructions()[index];
  switch (i.op) {
    case Op::OpTraceRayKHR:
      traces_.push_back({index, module_.location(i, "traceRayEXT"), module_.access(i.at(10)).variable,
                         values(index, i.at(1)), values(index, i.at(2)), values(index, i.at(3)), values(index, i.at(4)),
                         values(index, i.at(5)),
                         flows_[module_.position(index)->function].inLoop(module_.position(index)->block)});
      return;
    case Op::OpExecuteCallableKHR:
      calls_.push_back(
          {index, module_.location(i, "executeCallableEXT"), module_.access(i.at(1)).variable, values(index, i.at(0))});
      return;
    case Op::OpReportIntersectionKHR:
      reports_.push_back({index, module_.location(i, "reportIntersectionEXT"), values(index, i.at(1))});
      return;
    case Op::OpIgnoreIntersectionKHR: ignores_ = true; return;
    case Op::OpTerminateRayKHR: terminates_ = true; return;
    case Op::OpLoad: return addAccess(index, i.at(0), true, false);
    case Op::OpStore: return addAccess(index, i.at(0), false, true);
    case Op::OpAccessChain:
    case Op::OpInBoundsAccessChain:
    case Op::OpCopyObject:
    case Op::OpLabel: return;
    default:  // any other use of a pointer to a shared variable
      for (const Id id : valueOperands(i))
        if (module_.types().get(module_.definition(id) ? module_.definition(id)->type : 0).kind == Type::Kind::pointer)
          addAccess(index, id, true, true);
  }
}

void StageFacts::addAccess(std::size_t index, Id pointer, bool reads, bool writes) {
  const Instruction& instruction = module_.instructions()[index];
  const Access access = module_.access(pointer);
  if (const Variable* variable = module_.variable(access.variable); variable && variable->builtIn && reads)
    builtIns_.push_back({*variable->builtIn, index, module_.location(instruction), false});
  const SharedVariable* shared = variable(access.variable);
  if (!shared) return;
  const bool structure = module_.types().get(shared->type).kind == Type::Kind::structure;
  if (!structure) {
    accesses_.push_back({index, shared->id, 0, reads && !writes ? instruction.result : 0, reads, writes});
  } else if (!access.indices.empty() && access.indices[0]) {
    accesses_.push_back(
        {index, shared->id, *access.indices[0], reads && !writes ? instruction.result : 0, reads, writes});
  } else if (access.indices.empty() && instruction.op == Op::OpLoad) {
    addWholeLoad(index, shared->id);
  } else if (access.indices.empty() && instruction.op == Op::OpStore) {
    addWholeStore(index, shared->id, instruction.at(1));
  } else {
    accesses_.push_back({index, shared->id, kWholeValue, 0, reads, writes});
  }
}

// Adds the members that are extracted from the value, and the whole value if it has any other use.
void StageFacts::addWholeLoad(std::size_t index, Id variable) {
  bool whole = false;
  for (const std::size_t user : module_.users(module_.instructions()[index].result)) {
    const Instruction& use = module_.instructions()[user];
    if (use.op == Op::OpCompositeExtract)
      accesses_.push_back({index, variable, use.at(1), use.result, true, false});
    else
      whole = true;
  }
  if (whole) accesses_.push_back({index, variable, kWholeValue, 0, true, false});
}

// A member that a store of the whole value puts back unchanged is not written: this is how `inout` parameters compile.
void StageFacts::addWholeStore(std::size_t index, Id variable, Id value) {
  const Instruction* made = module_.definition(value);
  const auto unchanged = [&](std::uint32_t member, Id part) {
    const Instruction* from = module_.definition(part);
    if (from && from->op == Op::OpCompositeExtract && from->operands.size() == 2 && from->at(1) == member) {
      const Instruction* whole = module_.definition(from->at(0));
      const Access access = whole && whole->op == Op::OpLoad ? module_.access(whole->at(0)) : Access{};
      return access.variable == variable && access.indices.empty();
    }
    const Access access = from && from->op == Op::OpLoad ? module_.access(from->at(0)) : Access{};
    return access.variable == variable && access.indices.size() == 1 && access.indices[0] == member;
  };
  if (!made || made->op != Op::OpCompositeConstruct) {
    accesses_.push_back({index, variable, kWholeValue, 0, false, true});
    return;
  }
  for (std::uint32_t member = 0; member < made->operands.size(); ++member)
    if (!unchanged(member, made->at(member))) accesses_.push_back({index, variable, member, 0, false, true});
}

const SharedVariable* StageFacts::incoming(spv::StorageClass storage) const {
  const SharedVariable* found = nullptr;
  for (const SharedVariable& variable : variables_)
    if (variable.storage == storage && variable.used) found = found ? found : &variable;
  return found;
}

const SharedVariable* StageFacts::variable(Id id) const {
  const auto found = std::ranges::find(variables_, id, &SharedVariable::id);
  return found == variables_.end() || id == 0 ? nullptr : &*found;
}

std::uint32_t StageFacts::memberCount(Id id) const {
  const SharedVariable* shared = variable(id);
  const Type& type = module_.types().get(shared ? shared->type : 0);
  return type.kind == Type::Kind::structure ? static_cast<std::uint32_t>(type.members.size()) : 1;
}

std::uint64_t StageFacts::frameBytes() const {
  std::uint64_t bytes = 0;
  for (const SharedVariable& variable : variables_) {
    const bool own = variable.storage == StorageClass::RayPayloadKHR ||
                     variable.storage == StorageClass::CallableDataKHR ||
                     variable.storage == StorageClass::HitAttributeKHR;
    if (own && variable.used) bytes += module_.types().get(variable.type).bytes;
  }
  return bytes;
}

bool StageFacts::reads(Id variable, std::uint32_t member) const {
  return std::ranges::any_of(accesses_, [&](const AccessFacts& a) {
    return a.reads && a.variable == variable && (a.member == member || a.member == kWholeValue);
  });
}

bool StageFacts::readsBeforeWriting(Id variable, std::uint32_t member) const {
  const Indices marks = writers(variable, member);
  return std::ranges::any_of(accesses_, [&](const AccessFacts& a) {
    return a.reads && a.variable == variable && (a.member == member || a.member == kWholeValue) &&
           !runsAlwaysBefore(marks, a.instruction);
  });
}

bool StageFacts::writes(Id variable, std::uint32_t member) const { return !writers(variable, member).empty(); }

Indices StageFacts::writers(Id variable, std::uint32_t member) const {
  Indices result;
  for (const AccessFacts& a : accesses_)
    if (a.writes && a.variable == variable && (a.member == member || a.member == kWholeValue))
      result.push_back(a.instruction);
  for (const TraceFacts& trace : traces_)
    if (trace.payload == variable) result.push_back(trace.instruction);
  for (const CallFacts& call : calls_)
    if (call.data == variable) result.push_back(call.instruction);
  return result;
}

// True if each path from the stage's start to the instruction passes one of the marks. The body of a loop that does not
// contain the instruction counts as executed.
bool StageFacts::runsAlwaysBefore(Indices marks, std::size_t instruction) const {
  const auto goal = module_.position(instruction);
  const Function* entry = module_.entry();
  if (!goal || !entry || &module_.functions()[goal->function] != entry) return true;  // not inlined: assumed
  const auto& blocks = entry->blocks;
  const ControlFlow& flow = flows_[goal->function];
  Indices first(blocks.size(), kNone);  // first mark of each block
  for (const std::size_t mark : marks) {
    const auto position = module_.position(mark);
    if (!position || position->function != goal->function) return true;
    first[position->block] = std::min(first[position->block], mark);
  }
  for (const auto& [header, merge] : loops(module_, *entry)) {
    const auto inside = [&, h = header, m = merge](std::size_t block) {
      return flow.dominates(h, block) && !flow.dominates(m, block);
    };
    if (inside(goal->block)) continue;
    for (std::size_t b = 0; b < blocks.size(); ++b)
      if (first[b] != kNone && inside(b)) first[header] = std::min(first[header], blocks[header].first);
  }
  std::vector<bool> seen(blocks.size(), false);
  Indices open{0};
  while (!open.empty()) {
    const std::size_t block = open.back();
    open.pop_back();
    if (seen[block]) continue;
    seen[block] = true;
    if (block == goal->block && instruction <= first[block]) return false;
    if (first[block] != kNone) continue;
    open.insert(open.end(), blocks[block].successors.begin(), blocks[block].successors.end());
  }
  return true;
}

bool StageFacts::writesAlways(Id variable, std::uint32_t member) const {
  const Indices marks = writers(variable, member);
  const Function* entry = module_.entry();
  if (marks.empty() || !entry) return false;
  for (const Block& block : entry->blocks)
    if (module_.instructions()[block.end - 1].op == Op::OpReturn && !runsAlwaysBefore(marks, block.end - 1))
      return false;
  return true;
}

bool StageFacts::writtenBefore(Id variable, std::uint32_t member, std::size_t instruction) const {
  Indices marks = writers(variable, member);
  std::erase(marks, instruction);
  return !marks.empty() && runsAlwaysBefore(std::move(marks), instruction);
}

Indices StageFacts::readsAfter(const PathsAfter& paths, const TraceFacts& trace, std::uint32_t member) const {
  const Indices kills = writers(trace.payload, member);
  Indices result;
  for (std::size_t i = 0; i < accesses_.size(); ++i) {
    const AccessFacts& a = accesses_[i];
    if (a.reads && a.variable == trace.payload && a.member == member && a.value != 0 &&
        paths.reaches(a.instruction, kills))
      result.push_back(i);
  }
  return result;
}

std::vector<std::size_t> StageFacts::readsAfter(const TraceFacts& trace, std::uint32_t member) const {
  const auto position = module_.position(trace.instruction);
  if (!position) return {};
  return readsAfter(PathsAfter(module_, flows_[position->function], trace.instruction), trace, member);
}

std::vector<std::size_t> StageFacts::unguardedReads(const TraceFacts& trace, std::uint32_t member) const {
  const auto position = module_.position(trace.instruction);
  if (!position) return {};
  const PathsAfter paths(module_, flows_[position->function], trace.instruction);
  Indices result = readsAfter(paths, trace, member);
  std::erase_if(result, [&](std::size_t i) {
    return guarded(paths, accesses_[i].instruction, trace.payload) || !usedUnguarded(paths, accesses_[i]);
  });
  return result;
}

bool StageFacts::dependsOnPayload(Id value, Id payload) const {
  const auto [found, isNew] = dependsOnPayload_.try_emplace({value, payload}, false);
  if (!isNew) return found->second;
  const auto position = module_.position(module_.definitionIndex(value));
  if (!position) return false;  // a constant
  const auto loads = [&](const Instruction& i) {
    return i.op == Op::OpLoad && module_.access(i.at(0)).variable == payload;
  };
  found->second = dependsOnDataOrControl(module_, flows_[position->function], value, loads);
  return found->second;
}

bool StageFacts::guarded(const PathsAfter& paths, std::size_t instruction, Id payload) const {
  const auto position = module_.position(instruction);
  if (!position) return false;
  const ControlFlow& flow = flows_[position->function];
  return std::ranges::any_of(paths.guards(instruction),
                             [&](std::size_t block) { return dependsOnPayload(flow.condition(block), payload); });
}

// True if the instruction chooses, by a condition on the payload, between the value and one that does not come from the
// member.
bool StageFacts::choosesByPayload(const Instruction& use, Id value, const AccessFacts& read) const {
  std::vector<Id> choices, conditions;
  if (use.op == Op::OpPhi) {
    const auto position = module_.position(module_.definitionIndex(use.result));
    if (!position) return false;
    for (std::size_t i = 0; i < use.operands.size(); i += 2) choices.push_back(use.at(i));
    conditions = flows_[position->function].phiConditions(position->block);
  } else if (use.op == Op::OpSelect && use.at(0) != value) {
    choices = {use.at(1), use.at(2)};
    conditions = {use.at(0)};
  }
  const auto isRead = [&](const Instruction& i) {
    return i.result != 0 && std::ranges::any_of(accesses_, [&](const AccessFacts& a) {
             return a.value == i.result && a.variable == read.variable && a.member == read.member;
           });
  };
  const bool hasAlternative =
      std::ranges::any_of(choices, [&](Id id) { return id != use.result && !dependsOn(module_, id, isRead); });
  return hasAlternative && std::ranges::any_of(conditions, [&](Id c) { return dependsOnPayload(c, read.variable); });
}

// True if the value that was read has an effect on a path that no condition on the payload guards.
bool StageFacts::usedUnguarded(const PathsAfter& paths, const AccessFacts& read) const {
  std::vector<Id> open{read.value};
  std::unordered_set<Id> seen{read.value};
  while (!open.empty()) {
    const Id next = open.back();
    open.pop_back();
    for (const std::size_t user : module_.users(next)) {
      const Instruction& use = module_.instructions()[user];
      if (guarded(paths, user, read.variable) || choosesByPayload(use, next, read)) continue;
      if (hasEffect(use.op)) return true;
      if (use.result != 0 && seen.insert(use.result).second) open.push_back(use.result);
    }
  }
  return false;
}

}  // namespace quintet::spirv
