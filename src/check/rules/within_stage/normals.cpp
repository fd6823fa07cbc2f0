// SPDX-License-Identifier: Apache-2.0
// Q702: a normal that is transformed to world space with gl_ObjectToWorldEXT, like a direction. Normals are
// recognized by name: that of the member or variable that the vector was loaded from, or a name in the line of the
// multiplication.
#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <regex>

#include "check/rules/rules.h"
#include "spirv/source_text.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::Op;

bool isNormalName(std::string_view name) {
  // Matches normal, worldNormal, vertex_normals, N, n0, Ng, but not normalized or normalMatrix.
  static const std::regex kPattern(
      "(.*_)?([nN]|[nN][0-9gs]|nrm|nor)|(.*[^a-zA-Z])?[nN]ormals?[0-9]?|.*[a-z]Normals?[0-9]?");
  return std::regex_match(name.begin(), name.end(), kPattern);
}

// True for instructions that only rearrange parts: the result is still that matrix or its upper 3 x 3 part.
bool rearranges(Op op) {
  return op == Op::OpLoad || op == Op::OpCompositeExtract || op == Op::OpCompositeConstruct ||
         op == Op::OpVectorShuffle || op == Op::OpCopyObject || op == Op::OpPhi || op == Op::OpAccessChain ||
         op == Op::OpInBoundsAccessChain;
}

bool isObjectToWorld(const spirv::Module& module, spirv::Id matrix) {
  bool found = false, other = false;
  spirv::findInSlice(
      module, matrix,
      [&](const spirv::Instruction& i) {
        if (spirv::loadsBuiltIn(module, i, spv::BuiltIn::ObjectToWorldKHR))
          found = true;
        else if (i.op == Op::OpLoad || !(rearranges(i.op) || module.isConstant(i.result) || i.op == Op::OpVariable))
          other = true;
        return other;
      },
      [](const spirv::Instruction& i) { return i.op == Op::OpLoad; });
  return found && !other;
}

// Returns the vec3 of the right operand, which is a vec3 or a vec4 with w = 0; 0 if it is a point.
spirv::Id directionOf(const spirv::Module& module, spirv::Id vector) {
  const spirv::Instruction* value = module.definition(vector);
  if (!value) return 0;
  const auto& type = module.types().get(value->type);
  if (type.count == 3) return vector;
  if (value->op != Op::OpCompositeConstruct || value->operands.empty()) return 0;
  const auto w = module.constantFloat(value->operands.back());
  return w && *w == 0.0 ? value->at(0) : 0;
}

// True if the result of an instruction on a normal is a normal: sums, scaling, signs, but not cross products.
bool keepsNormal(const spirv::Module& module, const spirv::Instruction& i) {
  switch (i.op) {
    case Op::OpFAdd:
    case Op::OpFSub:
    case Op::OpFMul:
    case Op::OpFDiv:
    case Op::OpFNegate:
    case Op::OpVectorTimesScalar:
    case Op::OpSelect:
    case Op::OpPhi:
    case Op::OpCopyObject:
    case Op::OpCompositeConstruct:
    case Op::OpCompositeExtract:
    case Op::OpVectorShuffle: return true;
    default:
      return spirv::isExtended(module, i, GLSLstd450Normalize) || spirv::isExtended(module, i, GLSLstd450FMix) ||
             spirv::isExtended(module, i, GLSLstd450FaceForward);
  }
}

// True if a name on the path of the loaded pointer is that of a normal: payload.hit.normal, buffer.normals[i].
bool loadsNormal(const spirv::Module& module, const spirv::Instruction& load) {
  if (load.op != Op::OpLoad) return false;
  spirv::Id pointer = load.at(0);
  for (int depth = 0; depth < 16; ++depth) {
    if (isNormalName(module.name(pointer))) return true;
    const spirv::Instruction* definition = module.definition(pointer);
    if (!definition || (definition->op != Op::OpAccessChain && definition->op != Op::OpInBoundsAccessChain))
      return false;
    const spirv::Instruction* base = module.definition(definition->at(0));
    spirv::Id type = base ? module.types().get(base->type).element : 0;
    for (std::size_t i = 1; i < definition->operands.size(); ++i) {
      const auto& t = module.types().get(type);
      if (t.kind != spirv::Type::Kind::structure) {
        type = t.element;
        continue;
      }
      const auto member = module.constantBits(definition->at(i));
      if (!member || *member >= t.members.size()) return false;
      if (isNormalName(t.memberNames[*member])) return true;
      type = t.members[*member];
    }
    pointer = definition->at(0);
  }
  return false;
}

std::string lastPart(const std::string& name) { return name.substr(name.rfind('.') + 1); }

// True if the line multiplies by a name of a normal: "* vec4(hit.normal, 0.0)", "* normalize(n)", "* (n0 * b.x".
bool multipliesNormal(const std::string& line) {
  static const std::regex kFactor(R"(\*\s*(?:vec4\s*\(\s*)?(?:normalize\s*\(\s*)?\(*\s*-?\s*([A-Za-z_][\w.]*))");
  for (std::sregex_iterator i(line.begin(), line.end(), kFactor), end; i != end; ++i)
    if (isNormalName(lastPart((*i)[1]))) return true;
  return false;
}

// True for lines such as "vec3 worldNormal = …" and "payload.normal = …".
bool assignsNormal(const std::string& line) {
  static const std::regex kAssignment(R"(^\s*(?:const\s+)?(?:vec3\s+)?([A-Za-z_][\w.]*)\s*=[^=])");
  std::smatch match;
  return std::regex_search(line, match, kAssignment) && isNormalName(lastPart(match[1]));
}

// True if a cross product uses the result: edges are transformed like directions, and their cross product is a normal.
bool isEdge(const spirv::Module& module, const spirv::Instruction& product) {
  const auto& users = module.users(product.result);
  return std::ranges::any_of(
      users, [&](std::size_t user) { return spirv::isExtended(module, module.instructions()[user], GLSLstd450Cross); });
}

// Returns the line of the instruction without its comment.
std::string sourceLine(const spirv::Module& module, const spirv::Instruction& instruction) {
  const SourceLocation location = module.location(instruction);
  const std::string line(spirv::lineOf(module.source(location.file), location.line));
  return line.substr(0, line.find("//"));
}

bool isNormal(const spirv::Module& module, const spirv::Instruction& product, spirv::Id direction) {
  const auto isLoad = [&](const spirv::Instruction& i) { return loadsNormal(module, i); };
  const auto leaves = [&](const spirv::Instruction& i) { return !keepsNormal(module, i); };
  if (spirv::dependsOn(module, direction, isLoad, leaves)) return true;
  const std::string line = sourceLine(module, product);
  return multipliesNormal(line) || (assignsNormal(line) && !isEdge(module, product));
}

}  // namespace

void checkNormals(const spirv::Module& module, Report& report) {
  for (const spirv::Instruction& product : module.instructions()) {
    if (product.op != Op::OpMatrixTimesVector || !isObjectToWorld(module, product.at(0))) continue;
    const spirv::Id direction = directionOf(module, product.at(1));
    if (direction == 0 || !isNormal(module, product, direction)) continue;
    const std::string_view matrix = "gl_ObjectToWorldEXT";
    const bool named = sourceLine(module, product).find(matrix) != std::string::npos;
    report.addOncePerLine("Q702", module.location(product, named ? matrix : ""),
                          "a normal is multiplied by gl_ObjectToWorldEXT; with non-uniform scale the result is not "
                          "perpendicular to the surface");
  }
}

}  // namespace quintet::check
