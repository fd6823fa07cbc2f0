// SPDX-License-Identifier: Apache-2.0
// Q705: a ray with tmin 0 whose origin is a hit position without an offset.
//
// A hit position is recognized by its computation: origin + t * direction, with the t of the hit in a hit shader or
// of a ray that the shader traced; or vertices that are interpolated with the barycentrics and transformed to world
// space. A closest-hit shader can also pass it to the tracing stage in the payload. tmin can be 0 as the default of a
// parameter.
#include <fmt/format.h>

#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <map>
#include <utility>

#include "base/parallel.h"
#include "check/rules/rules.h"
#include "spirv/trace_instruction.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::Op;

// True if the scalar is the t of a hit: gl_HitTEXT, or a float in the payload of a ray that this shader traces.
bool isHitT(const spirv::Module& module, spirv::Id value) {
  const spirv::Instruction* definition = module.definition(value);
  if (!definition) return false;
  if (spirv::loadsBuiltIn(module, *definition, spv::BuiltIn::RayTmaxKHR))
    return module.stage() == spv::ExecutionModel::ClosestHitKHR;
  while (definition && (definition->op == Op::OpCompositeExtract || definition->op == Op::OpCopyObject))
    definition = module.definition(definition->at(0));
  if (!definition || definition->op != Op::OpLoad) return false;
  const spirv::Variable* variable = module.variable(module.access(definition->at(0)).variable);
  return variable && variable->storage == spv::StorageClass::RayPayloadKHR;
}

// Returns d if the value is d * t with the t of a hit, else 0.
spirv::Id directionOfStep(const spirv::Module& module, spirv::Id value) {
  const spirv::Instruction* step = module.definition(value);
  if (!step || step->op != Op::OpVectorTimesScalar || !isHitT(module, step->at(1))) return 0;
  return step->at(0);
}

// True if it is the direction of a trace of this shader or of the incoming ray, or normalized.
bool isRayDirection(const spirv::Module& module, spirv::Id direction) {
  const spirv::Instruction* definition = module.definition(direction);
  if (definition && spirv::isExtended(module, *definition, GLSLstd450Normalize))
    definition = module.definition(definition->at(2));
  if (definition && (spirv::loadsBuiltIn(module, *definition, spv::BuiltIn::WorldRayDirectionKHR) ||
                     spirv::loadsBuiltIn(module, *definition, spv::BuiltIn::ObjectRayDirectionKHR)))
    return true;
  for (const std::size_t user : module.users(direction)) {
    const auto ray = spirv::rayOperands(module.instructions()[user]);
    if (ray && ray->direction == direction) return true;
  }
  return false;
}

// False for a constant that no trace starts at: an offset from a point that was folded to 0.
bool canBeOrigin(const spirv::Module& module, spirv::Id value) {
  return !module.isConstant(value) || std::ranges::any_of(module.users(value), [&](std::size_t user) {
    const auto ray = spirv::rayOperands(module.instructions()[user]);
    return ray && ray->origin == value;
  });
}

// True for origin + t * direction.
bool isPointOnRay(const spirv::Module& module, const spirv::Instruction& value) {
  if (spirv::isExtended(module, value, GLSLstd450Fma)) {  // fma(vec3(t), direction, origin)
    for (const std::size_t k : {2u, 3u}) {
      const spirv::Instruction* t = module.definition(value.at(k));
      if (t && t->op == Op::OpCompositeConstruct && isHitT(module, t->at(0)) && isRayDirection(module, value.at(5 - k)))
        return true;
    }
  }
  if (value.op != Op::OpFAdd) return false;
  const spirv::Id a = directionOfStep(module, value.at(0)), b = directionOfStep(module, value.at(1));
  return (a != 0 && isRayDirection(module, a) && canBeOrigin(module, value.at(1))) ||
         (b != 0 && isRayDirection(module, b) && canBeOrigin(module, value.at(0)));
}

// True for a sum of vertices that are loaded from a buffer and multiplied by weights that are not constant.
bool isInterpolation(const spirv::Module& module, spirv::Id value, int depth = 0) {
  const spirv::Instruction* i = module.definition(value);
  if (!i || depth > 4) return false;
  if (i->op == Op::OpFAdd)
    return isInterpolation(module, i->at(0), depth + 1) && isInterpolation(module, i->at(1), depth + 1);
  if (depth == 0 || i->op != Op::OpVectorTimesScalar || module.isConstant(i->at(1))) return false;
  const spirv::Instruction* vertex = module.definition(i->at(0));
  if (!vertex || vertex->op != Op::OpLoad) return false;
  const spirv::Instruction* pointer = module.definition(vertex->at(0));
  const auto storage =
      pointer ? static_cast<spv::StorageClass>(module.types().get(pointer->type).storage) : spv::StorageClass::Max;
  return storage == spv::StorageClass::PhysicalStorageBuffer || storage == spv::StorageClass::StorageBuffer;
}

// True for gl_ObjectToWorldEXT * vec4(interpolated vertices, 1).
bool isPointByMatrix(const spirv::Module& module, const spirv::Instruction& value) {
  if (value.op != Op::OpMatrixTimesVector) return false;
  const spirv::Instruction* matrix = module.definition(value.at(0));
  if (!matrix || !spirv::loadsBuiltIn(module, *matrix, spv::BuiltIn::ObjectToWorldKHR)) return false;
  const spirv::Instruction* point = module.definition(value.at(1));
  if (!point || point->op != Op::OpCompositeConstruct) return false;
  spirv::Id vertex = point->at(0);
  const spirv::Instruction* part = module.definition(vertex);
  if (part && part->op == Op::OpCompositeExtract) vertex = part->at(0);  // vec4(p.x, p.y, p.z, 1)
  const spirv::Instruction* sum = module.definition(vertex);
  return isInterpolation(module, vertex) || (sum && isPointOnRay(module, *sum));
}

// True for the same computation by rows, as in the library: vec3(dot(row.xyz, p) + row.w, …).
bool isPointByRows(const spirv::Module& module, const spirv::Instruction& value) {
  if (value.op != Op::OpCompositeConstruct || value.operands.size() != 3) return false;
  for (const spirv::Id component : value.operands) {
    const spirv::Instruction* sum = module.definition(component);
    if (!sum || sum->op != Op::OpFAdd) return false;
    const spirv::Instruction* product = module.definition(sum->at(0));
    if (!product || product->op != Op::OpDot) return false;
    if (!isInterpolation(module, product->at(0)) && !isInterpolation(module, product->at(1))) return false;
  }
  return true;
}

bool isTransformedInterpolation(const spirv::Module& module, const spirv::Instruction& value) {
  return isPointByMatrix(module, value) || isPointByRows(module, value);
}

// True for instructions that select among values without computing.
bool chooses(Op op) {
  return op == Op::OpPhi || op == Op::OpSelect || op == Op::OpCopyObject || op == Op::OpLoad || op == Op::OpStore;
}

// Returns the first instruction for which `test` holds among those that `value` can be, through phis, selects and local
// variables. Null if not found.
const spirv::Instruction* findChoice(const spirv::Module& module, spirv::Id value, const spirv::InstructionTest& test) {
  return spirv::findInSlice(module, value, test, [](const spirv::Instruction& i) { return !chooses(i.op); });
}

bool canBeHitPosition(const spirv::Module& module, spirv::Id value) {
  return findChoice(module, value, [&](const spirv::Instruction& i) {
    return isPointOnRay(module, i) || isTransformedInterpolation(module, i);
  });
}

// Returns "tmin 0" if the trace starts there, with the parameter whose default it is; empty if it does not, or if tmin
// is unknown. `defaults` can be null.
std::string zeroText(const spirv::ValueRanges& ranges, const DefaultRanges* defaults, std::size_t trace,
                     spirv::Id tmin) {
  if (ranges.rangeAt(trace, tmin).constant() == 0.0) return "tmin 0";
  if (!defaults || defaults->at(trace, tmin).constant() != 0.0) return {};
  const std::string names = defaults->parameters({tmin});
  return names.empty() ? "" : fmt::format("tmin 0, the default of {},", names);
}

const spirv::Variable* storedIn(const spirv::Module& module, spirv::Id pointer, spv::StorageClass storage) {
  const spirv::Variable* variable = module.variable(module.access(pointer).variable);
  return variable && variable->storage == storage ? variable : nullptr;
}

// A trace with tmin 0 whose origin is a member of the payload of a ray that this shader traced before.
struct PayloadOrigin {
  std::size_t trace = 0;  // instruction
  std::string zero;       // zeroText
  spirv::Id payload = 0;
  std::uint32_t member = 0;  // 0 for a payload that is not a structure
};

std::vector<PayloadOrigin> payloadOrigins(const spirv::StageFacts& facts, const DefaultRanges* defaults) {
  const spirv::Module& module = facts.module();
  std::vector<PayloadOrigin> result;
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const auto ray = spirv::rayOperands(module.instructions()[i]);
    const std::string zero = ray ? zeroText(facts.ranges(), defaults, i, ray->tmin) : "";
    if (zero.empty()) continue;
    const auto isMember = [&](const spirv::Instruction& value) {
      return value.op == Op::OpLoad && storedIn(module, value.at(0), spv::StorageClass::RayPayloadKHR);
    };
    const spirv::Instruction* load = findChoice(module, ray->origin, isMember);
    if (!load) continue;
    const spirv::Access access = module.access(load->at(0));
    if (!access.indices.empty() && !access.indices[0]) continue;
    result.push_back({i, zero, access.variable, access.indices.empty() ? 0 : *access.indices[0]});
  }
  return result;
}

// True if a closest-hit shader stores its hit position, without an offset, to the member of its payload.
bool storesHitPosition(const spirv::Module& module, std::uint32_t member) {
  for (const spirv::Instruction& store : module.instructions()) {
    if (store.op != Op::OpStore || !storedIn(module, store.at(0), spv::StorageClass::IncomingRayPayloadKHR)) continue;
    const spirv::Access access = module.access(store.at(0));
    spirv::Id value = store.at(1);
    if (access.indices.empty()) {  // the whole payload, which can be a structure
      const spirv::Instruction* whole = module.definition(value);
      const bool structure = whole && module.types().get(whole->type).kind == spirv::Type::Kind::structure;
      if (structure && whole->op == Op::OpCompositeConstruct) value = whole->at(member);
    } else if (access.indices[0] != member) {
      continue;
    }
    if (canBeHitPosition(module, value)) return true;
  }
  return false;
}

// The lecture form compiles closest-hit sources twice. In the variant for triangles `hit` is zero, so an offset along
// hit.normal vanishes. Q705 counts there only if the variant for procedural geometry has it at the same line.
void dropZeroAttributes(const PipelineGraph& graph, std::vector<std::vector<Diagnostic>>& found) {
  constexpr std::string_view kTriangles = ".triangles.rchit", kBoxes = ".boxes.rchit";
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::string file = graph.stages[i].file;
    if (!file.ends_with(kTriangles)) continue;
    file.replace(file.size() - kTriangles.size(), kTriangles.size(), kBoxes);
    const PipelineStage* boxes = graph.stage(file);
    if (!boxes || !boxes->facts) continue;
    const auto& twin = found[static_cast<std::size_t>(boxes - graph.stages.data())];
    std::erase_if(found[i], [&](const Diagnostic& d) {
      return std::ranges::find(twin, d.line, &Diagnostic::line) == twin.end();
    });
  }
}

bool isOutgoing(const spirv::SharedVariable& variable) { return variable.storage == spv::StorageClass::RayPayloadKHR; }

// Whether closest-hit stages store their hit position in a member of their payload.
using StoringStages = std::map<std::pair<std::size_t, std::uint32_t>, bool>;

// Reports the origins that a trace gets from its payload, where a closest-hit shader stored its hit position.
void checkPayloadOrigins(const PipelineGraph& graph, std::size_t stage, StoringStages& storing, Report& report) {
  const spirv::StageFacts& facts = *graph.stages[stage].facts;
  const spirv::Module& module = facts.module();
  if (std::ranges::none_of(facts.variables(), isOutgoing)) return;
  for (const PayloadOrigin& origin : payloadOrigins(facts, graph.defaults(stage))) {
    for (const TraceSite& site : graph.tracesOf(stage)) {
      if (site.trace->payload != origin.payload) continue;
      for (const Edge& edge : site.edges) {
        const bool known = edge.exact || graph.usesLibrary;
        if (edge.role != Role::closestHit || !known) continue;
        const auto [stores, isNew] = storing.try_emplace({edge.stage, origin.member}, false);
        if (isNew) stores->second = storesHitPosition(graph.facts(edge).module(), origin.member);
        if (!stores->second) continue;
        const SourceLocation location = spirv::traceLocation(module, module.instructions()[origin.trace]);
        report.add("Q705", graph.location(graph.stages[stage], location),
                   fmt::format("the ray starts with {} at the hit position that the {} stores in the payload; "
                               "because of rounding it can hit the surface that it leaves",
                               origin.zero, graph.describe(edge)));
      }
    }
  }
}

void checkOrigins(const spirv::Module& module, const spirv::ValueRanges& ranges, const DefaultRanges* defaults,
                  Report& report) {
  for (std::size_t i = 0; i < module.instructions().size(); ++i) {
    const spirv::Instruction& trace = module.instructions()[i];
    const auto ray = spirv::rayOperands(trace);
    if (!ray || !canBeHitPosition(module, ray->origin)) continue;
    if (const std::string zero = zeroText(ranges, defaults, i, ray->tmin); !zero.empty())
      report.addOncePerLine(
          "Q705", spirv::traceLocation(module, trace),
          fmt::format("the ray starts with {} at a hit position; because of rounding it can hit the surface that it "
                      "leaves",
                      zero));
  }
}

}  // namespace

void checkRayOrigins(const spirv::Module& module, Report& report) {
  checkOrigins(module, spirv::ValueRanges(module), nullptr, report);
}

void checkRayOrigins(const CheckInput& input, Report& report) {
  const PipelineGraph& graph = input.graph;
  std::vector<std::vector<Diagnostic>> found(graph.stages.size());
  parallelFor(graph.stages.size(), [&](std::size_t i) {
    if (!graph.stages[i].facts) return;
    Report ofStage;
    const spirv::StageFacts& facts = *graph.stages[i].facts;
    if (facts.traces().empty()) return;
    checkOrigins(facts.module(), facts.ranges(), graph.defaults(i), ofStage);
    found[i] = ofStage.take();
  });
  dropZeroAttributes(graph, found);
  for (std::size_t i = 0; i < found.size(); ++i)
    for (Diagnostic& d : found[i])
      report.add(d.id, graph.location(graph.stages[i], {d.file, d.line, d.column}), std::move(d.text));
  StoringStages storing;
  for (std::size_t i = 0; i < graph.stages.size(); ++i)
    if (graph.stages[i].facts && !graph.stages[i].facts->traces().empty())
      checkPayloadOrigins(graph, i, storing, report);
}

}  // namespace quintet::check
