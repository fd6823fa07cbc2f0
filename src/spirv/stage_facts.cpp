// SPDX-License-Identifier: Apache-2.0
#include "spirv/stage_facts.h"

#include <algorithm>
#include <tuple>
#include <unordered_set>

#include "spirv/glsl_declaration.h"
#include "spirv/hit_objects.h"
#include "spirv/trace_instruction.h"
#include "spirv/value_flow.h"

namespace quintet::spirv {
namespace {

using spv::Op;
using spv::StorageClass;
using Indices = std::vector<std::size_t>;
constexpr std::size_t kNone = Module::kNone;
constexpr std::size_t kMaxPath = 32;  // of an extracted part

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
    return result;
  }
  result.declaration = module.declaration(variable.id);
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

// Returns the components of `vector` that a shuffle takes.
std::vector<std::uint32_t> shuffledFrom(const Module& module, const Instruction& shuffle, Id vector) {
  const auto sizeOf = [&](Id id) {
    const Instruction* value = module.definition(id);
    return value ? module.types().get(value->type).count : 0u;
  };
  const std::uint32_t first = sizeOf(shuffle.at(0)), second = sizeOf(shuffle.at(1));
  std::vector<std::uint32_t> result;
  for (std::size_t i = 2; i < shuffle.operands.size(); ++i) {
    const std::uint32_t component = shuffle.operands[i];
    if (component < first && shuffle.at(0) == vector) result.push_back(component);
    if (component >= first && component - first < second && shuffle.at(1) == vector)
      result.push_back(component - first);
  }
  return result;
}

// The values of any of the arguments; nothing is known without any.
ArgumentValues unionOf(const std::vector<ArgumentValues>& all) {
  if (all.empty() || !std::ranges::all_of(all, &ArgumentValues::known)) return {};
  ArgumentValues result = all.front();
  for (const ArgumentValues& next : all) {
    result.values.insert(result.values.end(), next.values.begin(), next.values.end());
    result.ones &= next.ones, result.zeros &= next.zeros;
    result.each = result.each && next.each;
  }
  std::ranges::sort(result.values);
  result.values.erase(std::unique(result.values.begin(), result.values.end()), result.values.end());
  result.min = result.values.front();
  result.each = result.each && result.values.size() == 1;
  return result;
}

bool hasEffect(Op op) {
  switch (op) {
    case Op::OpStore:
    case Op::OpTraceRayKHR:
    case Op::OpHitObjectTraceRayNV:
    case Op::OpHitObjectExecuteShaderNV:
    case Op::OpHitObjectRecordHitNV:
    case Op::OpHitObjectRecordHitWithIndexNV:
    case Op::OpHitObjectRecordMissNV:
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

bool ArgumentValues::mayBe(std::uint32_t value) const {
  return value >= min && (value & ones) == ones && (value & zeros) == 0;
}

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
  for (const Variable& variable : module_.variables()) {
    if (keywordOf(variable.storage).empty()) continue;
    variables_.push_back(sharedVariable(module_, variable));
    leaves_.emplace(variable.id, Leaves(module_.types(), variable.type));
  }
  std::ranges::stable_sort(variables_, {}, [](const SharedVariable& v) {
    return std::tuple(v.location.value_or(0), v.declaration.line, v.declaration.column);
  });
  if (const Function* entry = module_.entry()) loops_ = loops(module_, *entry);
  for (std::size_t i = 0; i < module_.instructions().size(); ++i)
    if (const auto position = module_.position(i); position && flows_[position->function].reachable(position->block))
      readInstruction(i);
  findExecuted();
  for (BuiltInRead& read : builtIns_)
    read.afterTrace = std::ranges::any_of(
        traces_, [&](const TraceFacts& trace) { return canRunAfter(module_, read.instruction, trace.instruction); });
  for (std::size_t i = 0; i < accesses_.size(); ++i)
    if (accesses_[i].reads && accesses_[i].value != 0) reads_[accesses_[i].value].push_back(i);
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
  const ValueRange range = ranges_.rangeAt(index, id);
  if (range.empty()) return result;
  for (const double value : range.values) result.values.push_back(static_cast<std::uint32_t>(std::int64_t(value)));
  std::ranges::sort(result.values);
  result.each = range.occurrence == Occurrence::each && !ranges_.guarded(index, id);
  result.ones = range.ones, result.zeros = range.zeros;
  if (range.min >= 0.0 && range.min <= 4294967295.0) result.min = static_cast<std::uint32_t>(range.min);
  result.known = !result.values.empty();
  if (result.known) result.min = result.values.front();
  return result;
}

void StageFacts::readInstruction(std::size_t index) {
  const Instruction& i = module_.instructions()[index];
  switch (i.op) {
    case Op::OpTraceRayKHR:
    case Op::OpHitObjectTraceRayNV:
    case Op::OpHitObjectExecuteShaderNV: return addTrace(index);
    case Op::OpExecuteCallableKHR:
      calls_.push_back(
          {index, module_.location(i, "executeCallableEXT"), module_.access(i.at(1)).variable, values(index, i.at(0))});
      return;
    case Op::OpReportIntersectionKHR:
      reports_.push_back({index, module_.location(i, "reportIntersectionEXT"), values(index, i.at(1))});
      return;
    case Op::OpIgnoreIntersectionKHR: ignores_ = true; return;
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

void StageFacts::addTrace(std::size_t index) {
  const Instruction& i = module_.instructions()[index];
  const Module::Position position = *module_.position(index);
  TraceFacts trace;
  trace.instruction = index;
  trace.location = traceLocation(module_, i);
  trace.inLoop = flows_[position.function].inLoop(position.block);
  if (const auto ray = rayOperands(i)) {
    trace.part = i.op == Op::OpTraceRayKHR ? TracePart::whole : TracePart::search;
    trace.payload = module_.access(ray->payload).variable;
    trace.flags = values(index, ray->flags);
    trace.mask = values(index, ray->mask);
    trace.offset = values(index, ray->offset);
    trace.stride = values(index, ray->stride);
    trace.miss = values(index, ray->miss);
    trace.ray = index;
    trace.missRuns = trace.part == TracePart::whole;
  } else {
    trace.part = TracePart::execution;
    trace.payload = module_.access(i.at(1)).variable;
  }
  if (trace.part != TracePart::whole) hitObjects_[trace.payload].push_back(module_.access(i.at(0)).variable);
  traces_.push_back(std::move(trace));
}

const TraceFacts* StageFacts::traceAt(std::size_t instruction) const {
  const auto found = std::ranges::lower_bound(traces_, instruction, {}, &TraceFacts::instruction);
  return found != traces_.end() && found->instruction == instruction ? &*found : nullptr;
}

// Connects the executions of hit objects with the searches that filled them.
void StageFacts::findExecuted() {
  for (TraceFacts& trace : traces_)
    if (trace.part == TracePart::execution) describeExecution(trace);
}

void StageFacts::describeExecution(TraceFacts& execution) {
  const HitObjectContent content = contentAt(module_, flows_, execution.instruction);
  const bool anything = content.traces.empty() && content.hits.empty() && content.misses.empty();
  for (TraceFacts& trace : traces_)
    if (content.known && content.mayBeMiss && std::ranges::count(content.traces, trace.instruction) > 0)
      trace.missRuns = true;
  execution.mayHit = content.mayBeHit;
  execution.mayMiss = content.mayBeMiss;
  execution.runsAll = content.known;
  std::vector<const TraceFacts*> traces;
  for (const std::size_t trace : content.traces) traces.push_back(traceAt(trace));
  if (anything || std::ranges::count(traces, nullptr) > 0) return;
  if (traces.size() == 1 && content.hits.empty() && content.misses.empty()) {
    execution.ray = traces[0]->instruction;
    execution.flags = traces[0]->flags, execution.mask = traces[0]->mask;
    execution.offset = traces[0]->offset, execution.stride = traces[0]->stride;
    execution.miss = traces[0]->miss;
    return;
  }
  std::vector<ArgumentValues> flags, offsets, strides, misses;
  for (const TraceFacts* trace : traces) {
    flags.push_back(trace->flags);
    offsets.push_back(trace->offset), strides.push_back(trace->stride);
    misses.push_back(trace->miss);
  }
  for (const std::size_t hit : content.hits) {
    const Instruction& record = module_.instructions()[hit];
    const bool byInstance = record.op == Op::OpHitObjectRecordHitNV;
    flags.emplace_back();
    offsets.push_back(byInstance ? values(hit, record.at(6)) : ArgumentValues{});
    strides.push_back(byInstance ? values(hit, record.at(7)) : ArgumentValues{});
  }
  for (const std::size_t miss : content.misses) misses.push_back(values(miss, module_.instructions()[miss].at(1)));
  execution.flags = unionOf(flags);
  execution.offset = unionOf(offsets);
  execution.stride = unionOf(strides);
  execution.miss = unionOf(misses);
}

void StageFacts::addAccess(std::size_t index, Id pointer, bool reads, bool writes) {
  const Instruction& instruction = module_.instructions()[index];
  const Access access = module_.access(pointer);
  if (const Variable* variable = module_.variable(access.variable); variable && variable->builtIn && reads)
    builtIns_.push_back({*variable->builtIn, index, module_.location(instruction), false});
  const SharedVariable* shared = variable(access.variable);
  if (!shared) return;
  const LeafRange range = leaves(shared->id).range(access.indices);
  const bool constant = std::ranges::all_of(access.indices, [](const auto& i) { return i.has_value(); });
  if (instruction.op == Op::OpLoad && constant) {
    Path path;
    for (const auto& i : access.indices) path.push_back(*i);
    addLoad(index, shared->id, path, instruction.result);
  } else if (instruction.op == Op::OpStore && range.exact) {
    addStore(index, shared->id, access, range, instruction.at(1));
  } else {
    const Id value = instruction.op == Op::OpLoad ? instruction.result : 0;
    accesses_.push_back({index, shared->id, range, value, reads, writes, false});
  }
}

// Adds the parts that are extracted from a loaded value, and the whole value if it has any other use. What is only stored
// to the variable again is left to addStore().
void StageFacts::addLoad(std::size_t index, Id variable, const Path& path, Id value) {
  const LeafRange range = leaves(variable).range(path);
  const Type::Kind kind = module_.types().get(module_.definition(value) ? module_.definition(value)->type : 0).kind;
  const auto isUsed = [&](Id id) {
    return std::ranges::any_of(module_.users(id),
                               [&](std::size_t user) { return !onlyStoredTo(variable, module_.instructions()[user]); });
  };
  if (range.count() <= 1 || path.size() > kMaxPath) {
    if (isUsed(value)) accesses_.push_back({index, variable, range, value, true, false, true});
    return;
  }
  bool whole = false;
  for (const std::size_t user : module_.users(value)) {
    const Instruction& use = module_.instructions()[user];
    if (use.op == Op::OpCompositeExtract && use.operands.size() > 1) {
      Path part = path;
      part.insert(part.end(), use.operands.begin() + 1, use.operands.end());
      addLoad(index, variable, part, use.result);
    } else if (use.op == Op::OpVectorShuffle && kind == Type::Kind::vector) {
      if (!isUsed(use.result)) continue;
      for (const std::uint32_t component : shuffledFrom(module_, use, value)) {
        Path part = path;
        part.push_back(component);
        accesses_.push_back({index, variable, leaves(variable).range(part), use.result, true, false, true});
      }
    } else {
      whole = whole || !onlyStoredTo(variable, use);
    }
  }
  if (whole) accesses_.push_back({index, variable, range, kind == Type::Kind::vector ? value : 0, true, false, true});
}

// True if the instruction only stores its operands to the variable, directly or as parts of composites.
bool StageFacts::onlyStoredTo(Id variable, const Instruction& use) const {
  std::vector<const Instruction*> open{&use};
  std::unordered_set<Id> seen;
  while (!open.empty()) {
    const Instruction& next = *open.back();
    open.pop_back();
    switch (next.op) {
      case Op::OpStore:
        if (module_.access(next.at(0)).variable != variable) return false;
        break;
      case Op::OpCompositeConstruct:
      case Op::OpCompositeInsert:
      case Op::OpCopyObject:
      case Op::OpCopyLogical:
        if (!seen.insert(next.result).second) break;
        for (const std::size_t user : module_.users(next.result)) {
          // What is extracted can be anything.
          if (module_.instructions()[user].op == Op::OpCompositeExtract) return false;
          open.push_back(&module_.instructions()[user]);
        }
        break;
      default: return false;
    }
  }
  return true;
}

// A leaf that a store puts back unchanged is not written: this is how `inout` parameters compile. A leaf that the store
// moves to a different one is read. A leaf of a local variable that was never set is not written.
void StageFacts::addStore(std::size_t index, Id variable, const Access& target, LeafRange range, Id value) {
  const Leaves& all = leaves(variable);
  const auto write = [&](std::uint32_t leaf) {
    AccessFacts* last = accesses_.empty() ? nullptr : &accesses_.back();
    if (last && last->instruction == index && last->writes && last->leaves.last == leaf)
      ++last->leaves.last;
    else
      accesses_.push_back({index, variable, {leaf, leaf + 1, true}, 0, false, true, false});
  };
  for (std::uint32_t leaf = range.first; leaf < range.last; ++leaf) {
    const Path& path = all.path(leaf);
    if (path.size() < target.indices.size()) {  // a part of the leaf
      write(leaf);
      continue;
    }
    const Path rest(path.begin() + static_cast<std::ptrdiff_t>(target.indices.size()), path.end());
    const ValuePart source = originOf(module_, {value, rest});
    const Instruction* load = module_.definition(source.id);
    if (load && load->op == Op::OpUndef) continue;
    const Access from = load && load->op == Op::OpLoad ? module_.access(load->at(0)) : Access{};
    const bool constant = std::ranges::all_of(from.indices, [](const auto& i) { return i.has_value(); });
    if (from.variable == variable && constant) {
      Path origin;
      for (const auto& i : from.indices) origin.push_back(*i);
      origin.insert(origin.end(), source.path.begin(), source.path.end());
      if (origin == path) continue;
      accesses_.push_back({module_.definitionIndex(source.id), variable, all.range(origin), value, true, false, false});
    }
    write(leaf);
  }
}

ValuePart StageFacts::storedValue(const AccessFacts& write, std::uint32_t leaf) const {
  const Instruction& store = module_.instructions()[write.instruction];
  if (store.op != Op::OpStore || !write.leaves.exact || !write.leaves.covers(leaf)) return {};
  const Path& path = leaves(write.variable).path(leaf);
  const std::size_t depth = module_.access(store.at(0)).indices.size();
  if (depth > path.size()) return {store.at(1), {}};
  return originOf(module_, {store.at(1), {path.begin() + static_cast<std::ptrdiff_t>(depth), path.end()}});
}

bool StageFacts::hasUnknownConstants() const {
  return std::ranges::any_of(module_.instructions(), [](const Instruction& i) {
    return i.op == Op::OpSpecConstant || i.op == Op::OpSpecConstantTrue || i.op == Op::OpSpecConstantFalse;
  });
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

const Leaves& StageFacts::leaves(Id variable) const {
  static const Leaves kNoLeaves;
  const auto found = leaves_.find(variable);
  return found == leaves_.end() ? kNoLeaves : found->second;
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

bool StageFacts::reads(Id variable, std::uint32_t leaf) const {
  return std::ranges::any_of(
      accesses_, [&](const AccessFacts& a) { return a.reads && a.variable == variable && a.leaves.covers(leaf); });
}

bool StageFacts::readsBeforeWriting(Id variable, std::uint32_t leaf) const {
  const auto [found, isNew] = readsBeforeWriting_.try_emplace({variable, leaf}, false);
  if (!isNew) return found->second;
  const Indices marks = writers(variable, leaf);
  found->second = std::ranges::any_of(accesses_, [&](const AccessFacts& a) {
    return a.reads && a.variable == variable && a.leaves.covers(leaf) && !runsAlwaysBefore(marks, a.instruction);
  });
  return found->second;
}

Indices StageFacts::inputReads(Id variable, std::uint32_t leaf) const {
  const Function* entry = module_.entry();
  if (!entry || entry->blocks.empty()) return {};
  const Indices marks = writers(variable, leaf);
  Indices result;
  for (std::size_t i = 0; i < accesses_.size(); ++i) {
    const AccessFacts& a = accesses_[i];
    if (!a.reads || a.writes || a.variable != variable || a.value == 0 || !a.leaves.exact || !a.leaves.covers(leaf))
      continue;
    const auto position = module_.position(a.instruction);
    if (!position || &module_.functions()[position->function] != entry) continue;
    const auto runsBefore = [&](std::size_t mark) { return canRunAfter(module_, a.instruction, mark); };
    if (std::ranges::any_of(marks, runsBefore) &&
        (runsAlwaysBefore(marks, a.instruction) || !runsInFirstIteration(a.instruction)))
      continue;
    const PathsAfter& paths = pathsAfter(entry->blocks[0].first);
    if (!guarded(paths, a.instruction, variable, {}) && usedUnguarded(paths, a, leaf, {})) result.push_back(i);
  }
  return result;
}

// True if each condition that decides whether the instruction runs is that of a loop around it, or holds in the first
// iteration.
bool StageFacts::runsInFirstIteration(std::size_t instruction) const {
  const auto position = module_.position(instruction);
  const Function* entry = module_.entry();
  if (!position || !entry) return false;
  const ControlFlow& flow = flows_[position->function];
  const auto initial = [&](Id id) -> std::optional<double> {
    const auto phi = module_.position(module_.definitionIndex(id));
    const Instruction* value = module_.definition(id);
    if (!value || value->op != Op::OpPhi || !phi) return {};
    for (std::size_t i = 0; i + 1 < value->operands.size(); i += 2) {
      const auto from = std::ranges::find(entry->blocks, value->at(i + 1), &Block::label);
      if (from == entry->blocks.end()) return {};
      if (!flow.dominates(phi->block, static_cast<std::size_t>(from - entry->blocks.begin())))
        return constantNumber(module_, {value->at(i), {}});
    }
    return {};
  };
  const PathsAfter& paths = pathsAfter(entry->blocks[0].first);
  for (const std::size_t guard : paths.guards(instruction)) {
    const Block& block = entry->blocks[guard];
    const Instruction& branch = module_.instructions()[block.end - 1];
    const auto outcome = branch.op == Op::OpBranchConditional ? evaluate(module_, branch.at(0), initial) : std::nullopt;
    if (outcome) {
      const auto next = std::ranges::find(entry->blocks, branch.at(*outcome != 0.0 ? 1 : 2), &Block::label);
      if (next == entry->blocks.end() ||
          !flow.dominates(static_cast<std::size_t>(next - entry->blocks.begin()), position->block))
        return false;
    } else if (std::ranges::none_of(loops_, [&](const auto& loop) { return loop.first == guard; })) {
      return false;
    }
  }
  return true;
}

bool StageFacts::writes(Id variable, std::uint32_t leaf) const { return !writers(variable, leaf).empty(); }

Indices StageFacts::writers(Id variable, std::uint32_t leaf) const {
  Indices result;
  for (const AccessFacts& a : accesses_)
    if (a.writes && a.variable == variable && a.leaves.covers(leaf)) result.push_back(a.instruction);
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
  for (const auto& [header, merge] : loops_) {
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

bool StageFacts::writesAlways(Id variable, std::uint32_t leaf) const {
  const auto [found, isNew] = writesAlways_.try_emplace({variable, leaf}, false);
  if (!isNew) return found->second;
  const Indices marks = writers(variable, leaf);
  const Function* entry = module_.entry();
  if (marks.empty() || !entry) return false;
  for (const Block& block : entry->blocks)
    if (module_.instructions()[block.end - 1].op == Op::OpReturn && !runsAlwaysBefore(marks, block.end - 1))
      return false;
  return found->second = true;
}

bool StageFacts::writtenBefore(Id variable, std::uint32_t leaf, std::size_t instruction) const {
  Indices marks = writers(variable, leaf);
  std::erase_if(marks, [&](std::size_t mark) {
    const TraceFacts* trace = traceAt(mark);
    return mark == instruction || (trace && trace->part == TracePart::search);
  });
  return !marks.empty() && runsAlwaysBefore(std::move(marks), instruction);
}

const PathsAfter& StageFacts::pathsAfter(std::size_t instruction) const {
  std::unique_ptr<PathsAfter>& paths = paths_[instruction];
  if (!paths) {
    const auto position = module_.position(instruction);
    paths = std::make_unique<PathsAfter>(module_, flows_[position ? position->function : 0], instruction);
  }
  return *paths;
}

Indices StageFacts::readsAfter(std::size_t site, Id variable, std::uint32_t leaf) const {
  if (!module_.position(site)) return {};
  const Indices kills = writers(variable, leaf);
  Indices result;
  for (std::size_t i = 0; i < accesses_.size(); ++i) {
    const AccessFacts& a = accesses_[i];
    if (a.reads && a.variable == variable && a.leaves.covers(leaf) && a.value != 0 &&
        pathsAfter(site).reaches(a.instruction, kills))
      result.push_back(i);
  }
  return result;
}

Indices StageFacts::unguardedReads(std::size_t site, Id variable, std::uint32_t leaf, const GuardTest& test) const {
  Indices result = readsAfter(site, variable, leaf);
  if (result.empty()) return result;
  const PathsAfter& paths = pathsAfter(site);
  std::erase_if(result, [&](std::size_t i) {
    return guarded(paths, accesses_[i].instruction, variable, test) || !usedUnguarded(paths, accesses_[i], leaf, test);
  });
  if (result.empty()) return result;
  // A loop around can reach the read without the condition, but only with a value that it has set.
  const PathsAfter unset(module_, flows_[module_.position(site)->function], site, writers(variable, leaf));
  std::erase_if(result, [&](std::size_t i) { return guarded(unset, accesses_[i].instruction, variable, test); });
  return result;
}

// True if the instruction asks about a hit object that is traced or executed with the variable.
bool StageFacts::queriesObjectOf(const Instruction& query, Id variable) const {
  const auto objects = hitObjects_.find(variable);
  if (objects == hitObjects_.end() || !queriesHitObject(module_, query)) return false;
  // The attributes can be those of any object.
  const Id object = query.op == Op::OpLoad ? 0 : module_.access(query.at(0)).variable;
  return object == 0 || std::ranges::count(objects->second, object) > 0 || std::ranges::count(objects->second, 0u) > 0;
}

// True if a branch with the condition can run on the paths. One that runs before and depends only on hit objects has decided about
// the start of the paths, not about what is read.
bool StageFacts::branchesAfter(const PathsAfter& paths, Id condition, Id variable) const {
  if (!hitObjects_.contains(variable)) return true;
  return std::ranges::any_of(module_.users(condition), [&](std::size_t user) {
    const Op op = module_.instructions()[user].op;
    return (op == Op::OpBranchConditional || op == Op::OpSwitch) && paths.reaches(user, {});
  });
}

bool StageFacts::dependsOnVariable(Id value, Id variable) const {
  const auto [found, isNew] = dependsOnVariable_.try_emplace({value, variable}, false);
  if (!isNew) return found->second;
  const auto position = module_.position(module_.definitionIndex(value));
  if (!position) return false;  // a constant
  const auto loads = [&](const Instruction& i) {
    return (i.op == Op::OpLoad && module_.access(i.at(0)).variable == variable) || queriesObjectOf(i, variable);
  };
  found->second = dependsOnDataOrControl(module_, flows_[position->function], value, loads);
  return found->second;
}

bool StageFacts::dependsOnLeaf(Id value, Id variable, std::uint32_t leaf) const {
  return dependsOn(module_, value, [&](const Instruction& i) {
    const auto found = reads_.find(i.result);
    return found != reads_.end() && std::ranges::any_of(found->second, [&](std::size_t read) {
             return accesses_[read].variable == variable && accesses_[read].leaves.covers(leaf);
           });
  });
}

// The branch of a block that decides whether the instruction runs.
Guard StageFacts::guardOf(const PathsAfter& paths, std::size_t block, std::size_t instruction) const {
  const auto position = module_.position(instruction);
  const auto& blocks = flows_[position->function].function().blocks;
  const Instruction& branch = module_.instructions()[blocks[block].end - 1];
  Guard guard{flows_[position->function].condition(block), {}};
  if (branch.op != Op::OpBranchConditional) return guard;
  const auto leads = [&](Id label) {
    const auto target = std::ranges::find(blocks, label, &Block::label);
    return target != blocks.end() && paths.leadsTo(static_cast<std::size_t>(target - blocks.begin()), instruction);
  };
  const bool ifTrue = leads(branch.at(1)), ifFalse = leads(branch.at(2));
  if (ifTrue != ifFalse) guard.holds = ifTrue;
  return guard;
}

bool StageFacts::guarded(const PathsAfter& paths, std::size_t instruction, Id variable, const GuardTest& test) const {
  const auto position = module_.position(instruction);
  if (!position) return false;
  const ControlFlow& flow = flows_[position->function];
  return std::ranges::any_of(paths.guards(instruction), [&](std::size_t block) {
    return dependsOnVariable(flow.condition(block), variable) && (!test || test(guardOf(paths, block, instruction)));
  });
}

// True if a condition on the variable guards each edge on which the phi takes the value.
bool StageFacts::arrivesGuarded(const PathsAfter& paths, const Instruction& phi, Id value, Id variable,
                                const GuardTest& test) const {
  const auto position = module_.position(module_.definitionIndex(phi.result));
  const auto& blocks = flows_[position->function].function().blocks;
  for (std::size_t i = 0; i + 1 < phi.operands.size(); i += 2) {
    const auto from = std::ranges::find(blocks, phi.at(i + 1), &Block::label);
    if (phi.at(i) != value || from == blocks.end()) continue;
    const Instruction& end = module_.instructions()[from->end - 1];
    if (guarded(paths, from->end - 1, variable, test)) continue;
    if (end.op != Op::OpBranchConditional || !dependsOnVariable(end.at(0), variable)) return false;
    const bool direct = end.at(1) != end.at(2);
    const Guard guard{end.at(0), direct ? std::optional(end.at(1) == blocks[position->block].label) : std::nullopt};
    if (!test(guard)) return false;
  }
  return true;
}

// True if the instruction chooses, by a condition on the variable, between the value and one that does not come from the
// leaf.
bool StageFacts::choosesByVariable(const PathsAfter& paths, const Instruction& use, Id value, const AccessFacts& read,
                                   std::uint32_t leaf, const GuardTest& test) const {
  std::vector<Id> choices, conditions;
  if (use.op == Op::OpLogicalAnd || use.op == Op::OpLogicalOr) {
    // In `payload.t < 0.0 || payload.done`, a miss decides.
    const Id other = use.at(0) == value ? use.at(1) : use.at(0);
    const bool decides = dependsOnVariable(other, read.variable) && !dependsOnLeaf(other, read.variable, leaf);
    return decides && (!test || test({other, use.op == Op::OpLogicalAnd}));
  }
  if (use.op == Op::OpPhi) {
    const auto position = module_.position(module_.definitionIndex(use.result));
    if (!position) return false;
    for (std::size_t i = 0; i < use.operands.size(); i += 2) choices.push_back(use.at(i));
    conditions = flows_[position->function].phiConditions(position->block);
  } else if (use.op == Op::OpSelect && use.at(0) != value) {
    choices = {use.at(1), use.at(2)};
    conditions = {use.at(0)};
  }
  const auto decides = [&](Id condition) {
    return dependsOnVariable(condition, read.variable) &&
           (use.op != Op::OpPhi || branchesAfter(paths, condition, read.variable));
  };
  if (std::ranges::none_of(conditions, decides)) return false;
  const bool hasAlternative =
      std::ranges::any_of(choices, [&](Id id) { return id != use.result && !dependsOnLeaf(id, read.variable, leaf); });
  if (!hasAlternative) return false;
  if (!test) return true;
  if (use.op == Op::OpPhi) return arrivesGuarded(paths, use, value, read.variable, test);
  return test({use.at(0), use.at(1) != use.at(2) ? std::optional(use.at(1) == value) : std::nullopt});
}

// True for a part of a loaded value that is an access of its own, and for a store that puts the leaf back.
bool StageFacts::isOwnAccess(const Instruction& use, Id value, const AccessFacts& read) const {
  if (!read.separateParts || value != read.value) return false;
  const bool part = use.op == Op::OpCompositeExtract || use.op == Op::OpVectorShuffle;
  return (part && read.leaves.count() > 1) || onlyStoredTo(read.variable, use);
}

// True if the value that was read has an effect on a path that no condition on the variable guards.
bool StageFacts::usedUnguarded(const PathsAfter& paths, const AccessFacts& read, std::uint32_t leaf,
                               const GuardTest& test) const {
  std::vector<Id> open{read.value};
  std::unordered_set<Id> seen{read.value};
  while (!open.empty()) {
    const Id next = open.back();
    open.pop_back();
    for (const std::size_t user : module_.users(next)) {
      const Instruction& use = module_.instructions()[user];
      if (isOwnAccess(use, next, read) || guarded(paths, user, read.variable, test) ||
          choosesByVariable(paths, use, next, read, leaf, test))
        continue;
      if (hasEffect(use.op)) return true;
      if (use.result != 0 && seen.insert(use.result).second) open.push_back(use.result);
    }
  }
  return false;
}

}  // namespace quintet::spirv
