// SPDX-License-Identifier: Apache-2.0
// Q703: gl_InstanceID as an index or as the identity of an instance. Q704: descriptor arrays indexed by a value that
// differs between invocations, without nonuniformEXT.
#include "check/rules/rules.h"
#include "spirv/control_flow.h"
#include "spirv/value_flow.h"
#include "spirv/value_ranges.h"

namespace quintet::check {
namespace {

using spv::Op;

bool isChain(Op op) { return op == Op::OpAccessChain || op == Op::OpInBoundsAccessChain || op == Op::OpPtrAccessChain; }

// True if a value selects something there: an element, an address, a case.
bool selects(const spirv::Module& module, const spirv::ValueRanges& ranges, const spirv::Instruction& i) {
  switch (i.op) {
    case Op::OpAccessChain:
    case Op::OpInBoundsAccessChain:
    case Op::OpPtrAccessChain:
    case Op::OpVectorExtractDynamic:
    case Op::OpConvertUToPtr:
    case Op::OpSwitch: return true;
    case Op::OpIEqual:
    case Op::OpINotEqual:
    case Op::OpSLessThan:
    case Op::OpULessThan:
    case Op::OpSLessThanEqual:
    case Op::OpULessThanEqual:
    case Op::OpSGreaterThan:
    case Op::OpUGreaterThan:
    case Op::OpSGreaterThanEqual:
    case Op::OpUGreaterThanEqual:  // a bounds check, such as index < frame.instanceCount, is not a choice
      return (module.isConstant(i.at(0)) || module.isConstant(i.at(1))) && !ranges.range(i.result).constant();
    default: return false;
  }
}

// True if the instruction reads a value that can differ between the invocations of a launch. Constants, push constants
// and uniforms do not differ, nor do values loaded from an address that does not.
bool readsVarying(const spirv::Module& module, const spirv::Instruction& i) {
  if (i.op != Op::OpLoad) return i.op == Op::OpImageRead || i.op == Op::OpAtomicIAdd;
  const spirv::Variable* variable = module.variable(module.access(i.at(0)).variable);
  if (!variable) return false;
  using Storage = spv::StorageClass;
  return variable->storage == Storage::Input || variable->storage == Storage::RayPayloadKHR ||
         variable->storage == Storage::IncomingRayPayloadKHR || variable->storage == Storage::HitAttributeKHR ||
         variable->storage == Storage::CallableDataKHR || variable->storage == Storage::IncomingCallableDataKHR;
}

// True if the value is the same in all invocations of a subgroup: engines loop over the different values.
bool isSubgroupUniform(const spirv::Module& module, spirv::Id value) {
  constexpr int kMaxCopies = 8;
  for (int k = 0; k < kMaxCopies; ++k) {
    const spirv::Instruction* i = module.definition(value);
    if (!i) return false;
    switch (i->op) {
      case Op::OpGroupNonUniformBroadcastFirst:
      case Op::OpGroupNonUniformBroadcast:
      case Op::OpSubgroupFirstInvocationKHR:
      case Op::OpSubgroupReadInvocationKHR: return true;
      case Op::OpBitcast:
      case Op::OpCopyObject:
      case Op::OpUConvert:
      case Op::OpSConvert: value = i->at(0); break;
      default: return false;
    }
  }
  return false;
}

// True if the value, or a condition that chooses it, can differ between the invocations that execute the instruction.
// The invocations count the steps of a loop together. `cause` becomes a description of the source of the value.
bool varies(const spirv::Module& module, std::size_t instruction, spirv::Id value, std::string* cause) {
  const auto position = module.position(instruction);
  if (!position) return false;
  const spirv::Instruction* found = nullptr;
  const spirv::ControlFlow flow(module, position->function);
  const auto test = [&](const spirv::Instruction& i) {
    if (readsVarying(module, i)) found = &i;
    return found != nullptr;
  };
  if (!spirv::dependsOnDataOrControl(module, flow, value, test, false)) return false;
  const auto builtIn = spirv::loadedBuiltIn(module, *found);
  if (found->op != Op::OpLoad)
    *cause = "a value read from memory";
  else if (builtIn)
    *cause = spirv::glslName(*builtIn);
  else
    *cause = "'" + module.name(module.access(found->at(0)).variable) + "'";
  return true;
}

bool isDescriptorArray(const spirv::Module& module, spirv::Id pointer) {
  const spirv::Variable* variable = module.variable(pointer);
  if (!variable) return false;
  using SpirvKind = spirv::Type::Kind;
  using Storage = spv::StorageClass;
  const SpirvKind kind = module.types().get(variable->type).kind;
  const bool descriptor = variable->storage == Storage::UniformConstant || variable->storage == Storage::Uniform ||
                          variable->storage == Storage::StorageBuffer;
  return descriptor && (kind == SpirvKind::array || kind == SpirvKind::runtimeArray);
}

// True if nonuniformEXT decorates the index, the pointer or the value that is loaded through it.
bool isNonUniform(const spirv::Module& module, const spirv::Instruction& chain) {
  const auto has = [&](spirv::Id id) { return module.decoration(id, spv::Decoration::NonUniform).has_value(); };
  if (has(chain.result) || has(chain.at(1))) return true;
  // Of an image, the operand of the access must have the decoration, which can be an OpSampledImage of what is loaded.
  for (const std::size_t user : module.users(chain.result)) {
    const spirv::Instruction& load = module.instructions()[user];
    if (has(load.result)) return true;
    for (const std::size_t next : module.users(load.result)) {
      const spirv::Instruction& use = module.instructions()[next];
      if ((use.op == Op::OpSampledImage || use.op == Op::OpImage || use.op == Op::OpCopyObject) && has(use.result))
        return true;
    }
  }
  return false;
}

}  // namespace

void checkInstanceIndices(const spirv::Module& module, Report& report) {
  const spirv::ValueRanges ranges(module);
  for (const spirv::Instruction& load : module.instructions()) {
    if (!spirv::loadsBuiltIn(module, load, spv::BuiltIn::InstanceId)) continue;
    const spirv::Instruction* use =
        spirv::findInUses(module, load.result, [&](const spirv::Instruction& i) { return selects(module, ranges, i); });
    if (!use) continue;
    report.addOncePerLine(
        "Q703", module.location(load, "gl_InstanceID"),
        "gl_InstanceID selects the data of an instance, but it is the position in the built list, which "
        "Quintet can sort; gl_InstanceCustomIndexEXT is the same on all devices");
  }
}

void checkDescriptorIndices(const spirv::Module& module, Report& report) {
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const spirv::Instruction& chain = module.instructions()[i];
    if (!isChain(chain.op) || !isDescriptorArray(module, chain.at(0)) || module.isConstant(chain.at(1))) continue;
    std::string cause;
    if (isNonUniform(module, chain) || isSubgroupUniform(module, chain.at(1)) ||
        !varies(module, i, chain.at(1), &cause))
      continue;
    const std::string name = module.name(chain.at(0));
    report.addOncePerLine("Q704", module.location(chain, name),
                          "the index of " + (name.empty() ? "an array of descriptors" : "'" + name + "'") +
                              " depends on " + cause +
                              ", which differs between invocations, but is not marked nonuniformEXT");
  }
}

}  // namespace quintet::check
