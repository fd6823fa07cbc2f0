// Reading a stage's facts off its module. What follows from control flow is in stage_paths.cpp.
#include "shader/stage_facts.h"

#include <algorithm>

#include "shader/glsl_declaration.h"
#include "shader/spirv_flow.h"

namespace quintet::shader {
namespace {

using spv::Op;
using spv::StorageClass;

// The qualifier of GLSL; empty for what stages do not share.
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

SharedVariable sharedVariable(const SpirvModule& module, const SpirvVariable& variable) {
  SharedVariable result{variable.id, variable.storage, variable.type, variable.name, {}, {}, false};
  for (const auto& [file, text] : module.sources()) {
    const auto found = findDeclaration(text, keywordOf(variable.storage), variable.name);
    if (!found) continue;
    result.place = {found->file.empty() ? file : found->file, found->line, found->column};
    result.location = found->location;
    break;
  }
  return result;
}

}  // namespace

bool ArgumentValues::may(std::uint32_t bits) const {
  return !known || std::ranges::any_of(values, [&](std::uint32_t value) { return (value & bits) != 0; });
}

bool ArgumentValues::must(std::uint32_t bits) const {
  return known && std::ranges::all_of(values, [&](std::uint32_t value) { return (value & bits) == bits; });
}

StageFacts::StageFacts(SpirvModule module) : module_(std::move(module)) {
  for (std::size_t i = 0; i < module_.functions().size(); ++i) flows_.emplace_back(module_, i);
  for (const SpirvVariable& variable : module_.variables())
    if (!keywordOf(variable.storage).empty()) variables_.push_back(sharedVariable(module_, variable));
  for (std::size_t i = 0; i < module_.instructions().size(); ++i)
    if (const auto position = module_.position(i); position && flows_[position->function].reachable(position->block))
      readInstruction(i);
  for (BuiltInRead& read : builtIns_)
    read.afterTrace = std::ranges::any_of(
        traces_, [&](const TraceFacts& trace) { return mayRunAfter(module_, read.instruction, trace.instruction); });
  markUsed();
}

void StageFacts::markUsed() {
  const auto mark = [&](SpirvId id) {
    for (SharedVariable& variable : variables_)
      if (variable.id == id) variable.used = true;
  };
  for (const AccessFacts& access : accesses_) mark(access.variable);
  for (const TraceFacts& trace : traces_) mark(trace.payload);
  for (const CallFacts& call : calls_) mark(call.data);
}

ArgumentValues StageFacts::values(SpirvId id) const {
  auto found = module_.possibleValues(id);
  return found ? ArgumentValues{true, std::move(*found)} : ArgumentValues{};
}

void StageFacts::readInstruction(std::size_t index) {
  const SpirvInstruction& i = module_.instructions()[index];
  switch (i.op) {
    case Op::OpTraceRayKHR:
      traces_.push_back({index, module_.place(i, "traceRayEXT"), module_.access(i.at(10)).variable, values(i.at(1)),
                         values(i.at(2)), values(i.at(3)), values(i.at(4)), values(i.at(5)),
                         flows_[module_.position(index)->function].inLoop(module_.position(index)->block)});
      return;
    case Op::OpExecuteCallableKHR:
      calls_.push_back(
          {index, module_.place(i, "executeCallableEXT"), module_.access(i.at(1)).variable, values(i.at(0))});
      return;
    case Op::OpReportIntersectionKHR:
      reports_.push_back({index, module_.place(i, "reportIntersectionEXT"), values(i.at(1))});
      return;
    case Op::OpIgnoreIntersectionKHR: ignores_ = true; return;
    case Op::OpTerminateRayKHR: terminates_ = true; return;
    case Op::OpLoad: return addAccess(index, i.at(0), true, false);
    case Op::OpStore: return addAccess(index, i.at(0), false, true);
    case Op::OpAccessChain:
    case Op::OpInBoundsAccessChain:
    case Op::OpCopyObject:
    case Op::OpLabel: return;
    default:  // whatever else has a pointer to a shared variable
      for (const SpirvId id : valueOperands(i))
        if (module_.types().get(module_.definition(id) ? module_.definition(id)->type : 0).kind ==
            SpirvType::Kind::pointer)
          addAccess(index, id, true, true);
  }
}

void StageFacts::addAccess(std::size_t index, SpirvId pointer, bool reads, bool writes) {
  const SpirvInstruction& instruction = module_.instructions()[index];
  const SpirvAccess access = module_.access(pointer);
  if (const SpirvVariable* variable = module_.variable(access.variable); variable && variable->builtIn && reads)
    builtIns_.push_back({*variable->builtIn, index, module_.place(instruction), false});
  const SharedVariable* shared = variable(access.variable);
  if (!shared) return;
  const bool structure = module_.types().get(shared->type).kind == SpirvType::Kind::structure;
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

// The members that are taken out of the value, and the whole if it goes somewhere as a whole.
void StageFacts::addWholeLoad(std::size_t index, SpirvId variable) {
  bool whole = false;
  for (const std::size_t user : module_.users(module_.instructions()[index].result)) {
    const SpirvInstruction& use = module_.instructions()[user];
    if (use.op == Op::OpCompositeExtract)
      accesses_.push_back({index, variable, use.at(1), use.result, true, false});
    else
      whole = true;
  }
  if (whole) accesses_.push_back({index, variable, kWholeValue, 0, true, false});
}

// Members that a store of the whole value puts back as they were are not written: an `inout` parameter does that.
void StageFacts::addWholeStore(std::size_t index, SpirvId variable, SpirvId value) {
  const SpirvInstruction* made = module_.definition(value);
  const auto unchanged = [&](std::uint32_t member, SpirvId part) {
    const SpirvInstruction* from = module_.definition(part);
    if (from && from->op == Op::OpCompositeExtract && from->operands.size() == 2 && from->at(1) == member) {
      const SpirvInstruction* whole = module_.definition(from->at(0));
      const SpirvAccess access = whole && whole->op == Op::OpLoad ? module_.access(whole->at(0)) : SpirvAccess{};
      return access.variable == variable && access.indices.empty();
    }
    const SpirvAccess access = from && from->op == Op::OpLoad ? module_.access(from->at(0)) : SpirvAccess{};
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

const SharedVariable* StageFacts::variable(SpirvId id) const {
  const auto found = std::ranges::find(variables_, id, &SharedVariable::id);
  return found == variables_.end() || id == 0 ? nullptr : &*found;
}

std::uint32_t StageFacts::memberCount(SpirvId id) const {
  const SharedVariable* shared = variable(id);
  const SpirvType& type = module_.types().get(shared ? shared->type : 0);
  return type.kind == SpirvType::Kind::structure ? static_cast<std::uint32_t>(type.members.size()) : 1;
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

}  // namespace quintet::shader
