// Q703: gl_InstanceID as an index or a name of an instance. Q704: arrays of descriptors indexed by what differs between
// invocations, without nonuniformEXT.
#include "program/check_shader_rules.h"

namespace quintet::program {

using shader::SpirvId;
using shader::SpirvInstruction;
using shader::SpirvModule;
using spv::Op;

namespace {

bool isChain(Op op) { return op == Op::OpAccessChain || op == Op::OpInBoundsAccessChain || op == Op::OpPtrAccessChain; }

// Where a value picks something: an element, an address, a case.
bool picks(const SpirvModule& module, const SpirvInstruction& i) {
  switch (i.op) {
    case Op::OpAccessChain:
    case Op::OpInBoundsAccessChain:
    case Op::OpPtrAccessChain:
    case Op::OpVectorExtractDynamic:
    case Op::OpConvertUToPtr:
    case Op::OpSwitch: return true;
    case Op::OpIEqual:
    case Op::OpINotEqual: return module.isConstant(i.at(0)) || module.isConstant(i.at(1));
    default: return false;
  }
}

// Does the value differ between invocations of a launch? Constants, push constants and uniforms do not, nor what is
// loaded from an address that does not.
bool varies(const SpirvModule& module, SpirvId value, std::string* cause) {
  const SpirvInstruction* found = findInSlice(module, value, [&](const SpirvInstruction& i) {
    if (i.op != Op::OpLoad) return i.op == Op::OpImageRead || i.op == Op::OpAtomicIAdd;
    const shader::SpirvVariable* variable = module.variable(module.access(i.at(0)).variable);
    if (!variable) return false;
    using Storage = spv::StorageClass;
    return variable->storage == Storage::Input || variable->storage == Storage::RayPayloadKHR ||
           variable->storage == Storage::IncomingRayPayloadKHR || variable->storage == Storage::HitAttributeKHR ||
           variable->storage == Storage::CallableDataKHR || variable->storage == Storage::IncomingCallableDataKHR;
  });
  if (!found) return false;
  const auto builtIn = loadedBuiltIn(module, *found);
  if (found->op != Op::OpLoad)
    *cause = "a value read from memory";
  else if (builtIn)
    *cause = glslName(*builtIn);
  else
    *cause = "'" + module.name(module.access(found->at(0)).variable) + "'";
  return true;
}

bool isDescriptorArray(const SpirvModule& module, SpirvId pointer) {
  const shader::SpirvVariable* variable = module.variable(pointer);
  if (!variable) return false;
  using Kind = shader::SpirvType::Kind;
  using Storage = spv::StorageClass;
  const Kind kind = module.types().get(variable->type).kind;
  const bool descriptor = variable->storage == Storage::UniformConstant || variable->storage == Storage::Uniform ||
                          variable->storage == Storage::StorageBuffer;
  return descriptor && (kind == Kind::array || kind == Kind::runtimeArray);
}

// nonuniformEXT marks the index, the pointer or what is loaded through it.
bool marked(const SpirvModule& module, const SpirvInstruction& chain) {
  const auto has = [&](SpirvId id) { return module.decoration(id, spv::Decoration::NonUniform).has_value(); };
  if (has(chain.result) || has(chain.at(1))) return true;
  for (const std::size_t user : module.users(chain.result))
    if (has(module.instructions()[user].result)) return true;
  return false;
}

}  // namespace

void checkInstanceIndex(const SpirvModule& module, Findings& findings) {
  for (const SpirvInstruction& load : module.instructions()) {
    if (!loadsBuiltIn(module, load, spv::BuiltIn::InstanceId)) continue;
    const SpirvInstruction* use =
        findInUses(module, load.result, [&](const SpirvInstruction& i) { return picks(module, i); });
    if (!use) continue;
    findings.add("Q703", load,
                 "gl_InstanceID picks what belongs to an instance, but it is the place in the list that was built, "
                 "which Quintet may sort: gl_InstanceCustomIndexEXT is the same on every device",
                 "gl_InstanceID");
  }
}

void checkDescriptorIndices(const SpirvModule& module, Findings& findings) {
  for (const SpirvInstruction& chain : module.instructions()) {
    if (!isChain(chain.op) || !isDescriptorArray(module, chain.at(0)) || module.isConstant(chain.at(1))) continue;
    std::string cause;
    if (marked(module, chain) || !varies(module, chain.at(1), &cause)) continue;
    const std::string name = module.name(chain.at(0));
    findings.add("Q704", chain,
                 "the index of '" + name + "' depends on " + cause +
                     ", which differs between invocations, and is not marked nonuniformEXT",
                 name);
  }
}

}  // namespace quintet::program
