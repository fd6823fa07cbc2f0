// What follows from a stage's control flow: which members are written on every path, and what is read after a trace.
#include <algorithm>
#include <unordered_set>

#include "shader/spirv_flow.h"
#include "shader/stage_facts.h"

namespace quintet::shader {
namespace {

using spv::Op;
using Indices = std::vector<std::size_t>;
constexpr std::size_t kNone = SpirvModule::kNone;

// Header and merge block of every loop of a function.
std::vector<std::pair<std::size_t, std::size_t>> loops(const SpirvModule& module, const SpirvFunction& function) {
  std::vector<std::pair<std::size_t, std::size_t>> result;
  for (std::size_t b = 0; b < function.blocks.size(); ++b) {
    const SpirvBlock& block = function.blocks[b];
    if (block.end - block.first < 2) continue;
    const SpirvInstruction& merge = module.instructions()[block.end - 2];
    if (merge.op != Op::OpLoopMerge) continue;
    const auto found = std::ranges::find(function.blocks, merge.at(0), &SpirvBlock::label);
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

bool StageFacts::reads(SpirvId variable, std::uint32_t member) const {
  return std::ranges::any_of(accesses_, [&](const AccessFacts& a) {
    return a.reads && a.variable == variable && (a.member == member || a.member == kWholeValue);
  });
}

bool StageFacts::takes(SpirvId variable, std::uint32_t member) const {
  const Indices marks = writers(variable, member);
  return std::ranges::any_of(accesses_, [&](const AccessFacts& a) {
    return a.reads && a.variable == variable && (a.member == member || a.member == kWholeValue) &&
           !runsAlwaysBefore(marks, a.instruction);
  });
}

bool StageFacts::writes(SpirvId variable, std::uint32_t member) const { return !writers(variable, member).empty(); }

Indices StageFacts::writers(SpirvId variable, std::uint32_t member) const {
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

// Does every path from the stage's start to the instruction meet a mark? The body of a loop that does not hold the
// instruction counts as run.
bool StageFacts::runsAlwaysBefore(Indices marks, std::size_t instruction) const {
  const auto goal = module_.position(instruction);
  const SpirvFunction* entry = module_.entry();
  if (!goal || !entry || &module_.functions()[goal->function] != entry) return true;  // not inlined: unknown
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

bool StageFacts::writesAlways(SpirvId variable, std::uint32_t member) const {
  const Indices marks = writers(variable, member);
  const SpirvFunction* entry = module_.entry();
  if (marks.empty() || !entry) return false;
  for (const SpirvBlock& block : entry->blocks)
    if (module_.instructions()[block.end - 1].op == Op::OpReturn && !runsAlwaysBefore(marks, block.end - 1))
      return false;
  return true;
}

bool StageFacts::writtenBefore(SpirvId variable, std::uint32_t member, std::size_t instruction) const {
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

bool StageFacts::dependsOnPayload(SpirvId value, SpirvId payload) const {
  const auto [found, isNew] = dependsOnPayload_.try_emplace({value, payload}, false);
  if (!isNew) return found->second;
  const auto position = module_.position(module_.definitionIndex(value));
  if (!position) return false;  // a constant
  const auto loads = [&](const SpirvInstruction& i) {
    return i.op == Op::OpLoad && module_.access(i.at(0)).variable == payload;
  };
  found->second = dependsWithChoices(module_, flows_[position->function], value, loads);
  return found->second;
}

bool StageFacts::guarded(const PathsAfter& paths, std::size_t instruction, SpirvId payload) const {
  const auto position = module_.position(instruction);
  if (!position) return false;
  const ControlFlow& flow = flows_[position->function];
  return std::ranges::any_of(paths.guards(instruction),
                             [&](std::size_t block) { return dependsOnPayload(flow.condition(block), payload); });
}

// Is it a choice by a condition on the payload between the value and one that does not come from the member?
bool StageFacts::choosesByPayload(const SpirvInstruction& use, SpirvId value, const AccessFacts& read) const {
  std::vector<SpirvId> choices, conditions;
  if (use.op == Op::OpPhi) {
    const auto position = module_.position(module_.definitionIndex(use.result));
    if (!position) return false;
    for (std::size_t i = 0; i < use.operands.size(); i += 2) choices.push_back(use.at(i));
    conditions = flows_[position->function].phiConditions(position->block);
  } else if (use.op == Op::OpSelect && use.at(0) != value) {
    choices = {use.at(1), use.at(2)};
    conditions = {use.at(0)};
  }
  const auto isRead = [&](const SpirvInstruction& i) {
    return i.result != 0 && std::ranges::any_of(accesses_, [&](const AccessFacts& a) {
             return a.value == i.result && a.variable == read.variable && a.member == read.member;
           });
  };
  const bool other =
      std::ranges::any_of(choices, [&](SpirvId id) { return id != use.result && !dependsOn(module_, id, isRead); });
  return other && std::ranges::any_of(conditions, [&](SpirvId c) { return dependsOnPayload(c, read.variable); });
}

// Does what was read have an effect on a path where no condition on the payload guards it?
bool StageFacts::usedUnguarded(const PathsAfter& paths, const AccessFacts& read) const {
  std::vector<SpirvId> open{read.value};
  std::unordered_set<SpirvId> seen{read.value};
  while (!open.empty()) {
    const SpirvId next = open.back();
    open.pop_back();
    for (const std::size_t user : module_.users(next)) {
      const SpirvInstruction& use = module_.instructions()[user];
      if (guarded(paths, user, read.variable) || choosesByPayload(use, next, read)) continue;
      if (hasEffect(use.op)) return true;
      if (use.result != 0 && seen.insert(use.result).second) open.push_back(use.result);
    }
  }
  return false;
}

}  // namespace quintet::shader
