// Q705: a ray with tmin 0 whose origin is just the hit position, without an offset.
//
// A hit position is recognised by how it is computed: origin + t * direction with the hit's t, in a hit shader or of a
// ray that this shader has traced; or vertices interpolated by the hit's barycentrics and carried to world space. One
// that a closest-hit shader hands over in the payload is found by check_stages.cpp.
#include "program/check_shader_rules.h"

namespace quintet::program {

using shader::SpirvId;
using shader::SpirvInstruction;
using shader::SpirvModule;
using spv::Op;

namespace {

// A scalar that is the hit's t: gl_HitTEXT, or a float of the payload of a ray that this shader traces.
bool isHitT(const SpirvModule& module, SpirvId value) {
  const SpirvInstruction* definition = module.definition(value);
  if (!definition) return false;
  if (loadsBuiltIn(module, *definition, spv::BuiltIn::RayTmaxKHR))
    return module.stage() == spv::ExecutionModel::ClosestHitKHR;
  while (definition && (definition->op == Op::OpCompositeExtract || definition->op == Op::OpCopyObject))
    definition = module.definition(definition->at(0));
  if (!definition || definition->op != Op::OpLoad) return false;
  const shader::SpirvVariable* variable = module.variable(module.access(definition->at(0)).variable);
  return variable && variable->storage == spv::StorageClass::RayPayloadKHR;
}

// d of d * t, where t is a hit's; 0: something else.
SpirvId directionOfStep(const SpirvModule& module, SpirvId value) {
  const SpirvInstruction* step = module.definition(value);
  if (!step || step->op != Op::OpVectorTimesScalar || !isHitT(module, step->at(1))) return 0;
  return step->at(0);
}

// Is it the direction that some trace of this shader takes, or that of the ray that arrived?
bool isRayDirection(const SpirvModule& module, SpirvId direction) {
  const SpirvInstruction* definition = module.definition(direction);
  if (definition && loadsBuiltIn(module, *definition, spv::BuiltIn::WorldRayDirectionKHR)) return true;
  for (const std::size_t user : module.users(direction)) {
    const SpirvInstruction& i = module.instructions()[user];
    if (i.op == Op::OpTraceRayKHR && i.at(8) == direction) return true;
  }
  return false;
}

// origin + t * direction, as a sum or as one fused multiply-add.
bool isPointOnRay(const SpirvModule& module, const SpirvInstruction& value) {
  if (value.op == Op::OpFAdd) {
    const SpirvId a = directionOfStep(module, value.at(0)), b = directionOfStep(module, value.at(1));
    return (a != 0 && isRayDirection(module, a)) || (b != 0 && isRayDirection(module, b));
  }
  return false;
}

// A sum of vertices, each loaded from a buffer and weighted by something that is no constant.
bool isInterpolation(const SpirvModule& module, SpirvId value, int depth = 0) {
  const SpirvInstruction* i = module.definition(value);
  if (!i || depth > 4) return false;
  if (i->op == Op::OpFAdd)
    return isInterpolation(module, i->at(0), depth + 1) && isInterpolation(module, i->at(1), depth + 1);
  if (depth == 0 || i->op != Op::OpVectorTimesScalar || module.isConstant(i->at(1))) return false;
  const SpirvInstruction* vertex = module.definition(i->at(0));
  if (!vertex || vertex->op != Op::OpLoad) return false;
  const SpirvInstruction* pointer = module.definition(vertex->at(0));
  const auto storage =
      pointer ? static_cast<spv::StorageClass>(module.types().get(pointer->type).storage) : spv::StorageClass::Max;
  return storage == spv::StorageClass::PhysicalStorageBuffer || storage == spv::StorageClass::StorageBuffer;
}

// gl_ObjectToWorldEXT * vec4(interpolated vertices, 1).
bool isPointByMatrix(const SpirvModule& module, const SpirvInstruction& value) {
  if (value.op != Op::OpMatrixTimesVector) return false;
  const SpirvInstruction* matrix = module.definition(value.at(0));
  if (!matrix || !loadsBuiltIn(module, *matrix, spv::BuiltIn::ObjectToWorldKHR)) return false;
  const SpirvInstruction* point = module.definition(value.at(1));
  if (!point || point->op != Op::OpCompositeConstruct) return false;
  SpirvId vertex = point->at(0);
  const SpirvInstruction* part = module.definition(vertex);
  if (part && part->op == Op::OpCompositeExtract) vertex = part->at(0);  // vec4(p.x, p.y, p.z, 1)
  return isInterpolation(module, vertex);
}

// The same by rows, as the library does: vec3(dot(row.xyz, p) + row.w, ...).
bool isPointByRows(const SpirvModule& module, const SpirvInstruction& value) {
  if (value.op != Op::OpCompositeConstruct || value.operands.size() != 3) return false;
  for (const SpirvId component : value.operands) {
    const SpirvInstruction* sum = module.definition(component);
    if (!sum || sum->op != Op::OpFAdd) return false;
    const SpirvInstruction* product = module.definition(sum->at(0));
    if (!product || product->op != Op::OpDot) return false;
    if (!isInterpolation(module, product->at(0)) && !isInterpolation(module, product->at(1))) return false;
  }
  return true;
}

bool isTransformedInterpolation(const SpirvModule& module, const SpirvInstruction& value) {
  return isPointByMatrix(module, value) || isPointByRows(module, value);
}

// Chooses among values, but computes nothing.
bool chooses(Op op) {
  return op == Op::OpPhi || op == Op::OpSelect || op == Op::OpCopyObject || op == Op::OpLoad || op == Op::OpStore;
}

// The first value for which `test` holds among those that `value` can be: through phi, select and locals.
const SpirvInstruction* findChoice(const SpirvModule& module, SpirvId value, const shader::InstructionTest& test) {
  return findInSlice(module, value, test, [](const SpirvInstruction& i) { return !chooses(i.op); });
}

bool canBeHitPosition(const SpirvModule& module, SpirvId value) {
  return findChoice(module, value, [&](const SpirvInstruction& i) {
    return isPointOnRay(module, i) || isTransformedInterpolation(module, i);
  });
}

bool startsAtZero(const SpirvModule& module, const SpirvInstruction& trace) {
  const auto tmin = module.constantFloat(trace.at(7));
  return tmin && *tmin == 0.0;
}

const shader::SpirvVariable* storedIn(const SpirvModule& module, SpirvId pointer, spv::StorageClass storage) {
  const shader::SpirvVariable* variable = module.variable(module.access(pointer).variable);
  return variable && variable->storage == storage ? variable : nullptr;
}

}  // namespace

void checkOrigins(const SpirvModule& module, Findings& findings) {
  for (const SpirvInstruction& trace : module.instructions()) {
    if (trace.op != Op::OpTraceRayKHR || !startsAtZero(module, trace) || !canBeHitPosition(module, trace.at(6)))
      continue;
    findings.add("Q705", trace,
                 "the ray starts at a hit position with tmin 0: by rounding it can hit the surface that it leaves",
                 "traceRayEXT");
  }
}

std::vector<PayloadOrigin> payloadOrigins(const SpirvModule& module) {
  std::vector<PayloadOrigin> result;
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const SpirvInstruction& trace = module.instructions()[i];
    if (trace.op != Op::OpTraceRayKHR || !startsAtZero(module, trace)) continue;
    const auto isMember = [&](const SpirvInstruction& value) {
      return value.op == Op::OpLoad && storedIn(module, value.at(0), spv::StorageClass::RayPayloadKHR);
    };
    const SpirvInstruction* load = findChoice(module, trace.at(6), isMember);
    if (!load) continue;
    const shader::SpirvAccess access = module.access(load->at(0));
    if (!access.indices.empty() && !access.indices[0]) continue;
    result.push_back({i, access.variable, access.indices.empty() ? 0 : *access.indices[0]});
  }
  return result;
}

bool storesHitPosition(const SpirvModule& module, std::uint32_t member) {
  for (const SpirvInstruction& store : module.instructions()) {
    if (store.op != Op::OpStore || !storedIn(module, store.at(0), spv::StorageClass::IncomingRayPayloadKHR)) continue;
    const shader::SpirvAccess access = module.access(store.at(0));
    SpirvId value = store.at(1);
    if (access.indices.empty()) {  // the whole payload, or one that is no structure
      const SpirvInstruction* whole = module.definition(value);
      const bool structure = whole && module.types().get(whole->type).kind == shader::SpirvType::Kind::structure;
      if (structure && whole->op == Op::OpCompositeConstruct) value = whole->at(member);
    } else if (access.indices[0] != member) {
      continue;
    }
    if (canBeHitPosition(module, value)) return true;
  }
  return false;
}

}  // namespace quintet::program
