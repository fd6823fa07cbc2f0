// Q702: a normal that is carried to world space like a direction, by gl_ObjectToWorldEXT. That a vector is a normal,
// only names say: of the member or variable that it was loaded from, or in the line of the multiplication.
#include <algorithm>
#include <regex>

#include "program/check_shader_rules.h"

namespace quintet::program {

using shader::SpirvId;
using shader::SpirvInstruction;
using shader::SpirvModule;
using spv::Op;

namespace {

bool isNormalName(std::string_view name) {
  // normal, worldNormal, vertex_normals, N, n0, Ng. Not "normalized", "normalMatrix".
  static const std::regex kPattern(
      "(.*_)?([nN]|[nN][0-9gs]|nrm|nor)|(.*[^a-zA-Z])?[nN]ormals?[0-9]?|.*[a-z]Normals?[0-9]?");
  return std::regex_match(name.begin(), name.end(), kPattern);
}

// Only rearranges parts: the value is still that matrix, or its upper 3 x 3 part.
bool rearranges(Op op) {
  return op == Op::OpLoad || op == Op::OpCompositeExtract || op == Op::OpCompositeConstruct ||
         op == Op::OpVectorShuffle || op == Op::OpCopyObject || op == Op::OpPhi || op == Op::OpAccessChain ||
         op == Op::OpInBoundsAccessChain;
}

bool isObjectToWorld(const SpirvModule& module, SpirvId matrix) {
  bool found = false, other = false;
  findInSlice(
      module, matrix,
      [&](const SpirvInstruction& i) {
        if (loadsBuiltIn(module, i, spv::BuiltIn::ObjectToWorldKHR))
          found = true;
        else if (i.op == Op::OpLoad || !(rearranges(i.op) || module.isConstant(i.result) || i.op == Op::OpVariable))
          other = true;
        return other;
      },
      [](const SpirvInstruction& i) { return i.op == Op::OpLoad; });
  return found && !other;
}

// The vector part of the right operand: of a vec4 with w = 0 or of a vec3. 0: it is a point.
SpirvId directionOf(const SpirvModule& module, SpirvId vector) {
  const SpirvInstruction* value = module.definition(vector);
  if (!value) return 0;
  const auto& type = module.types().get(value->type);
  if (type.count == 3) return vector;
  if (value->op != Op::OpCompositeConstruct || value->operands.empty()) return 0;
  const auto w = module.constantFloat(value->operands.back());
  return w && *w == 0.0 ? value->at(0) : 0;
}

// Keeps a normal a normal: sums, lengths and signs. A cross product makes something else of it.
bool keepsNormal(const SpirvModule& module, const SpirvInstruction& i) {
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
      return isExtended(module, i, glsl450::kNormalize) || isExtended(module, i, glsl450::kFMix) ||
             isExtended(module, i, glsl450::kFaceForward);
  }
}

// A name on the way of a pointer: "normal" of payload.hit.normal, "normals" of buffer.normals[i].
bool loadsNormal(const SpirvModule& module, const SpirvInstruction& load) {
  if (load.op != Op::OpLoad) return false;
  SpirvId pointer = load.at(0);
  for (int depth = 0; depth < 16; ++depth) {
    if (isNormalName(module.name(pointer))) return true;
    const SpirvInstruction* definition = module.definition(pointer);
    if (!definition || (definition->op != Op::OpAccessChain && definition->op != Op::OpInBoundsAccessChain))
      return false;
    const SpirvInstruction* base = module.definition(definition->at(0));
    SpirvId type = base ? module.types().get(base->type).element : 0;
    for (std::size_t i = 1; i < definition->operands.size(); ++i) {
      const auto& t = module.types().get(type);
      if (t.kind != shader::SpirvType::Kind::structure) {
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

// Does the line multiply something by a name of a normal: "* vec4(hit.normal, 0.0)", "* normalize(n)", "* (n0 * b.x"?
bool multipliesNormal(const std::string& line) {
  static const std::regex kFactor(R"(\*\s*(?:vec4\s*\(\s*)?(?:normalize\s*\(\s*)?\(*\s*-?\s*([A-Za-z_][\w.]*))");
  for (std::sregex_iterator i(line.begin(), line.end(), kFactor), end; i != end; ++i)
    if (isNormalName(lastPart((*i)[1]))) return true;
  return false;
}

// "vec3 worldNormal = ...", "payload.normal = ...".
bool assignsNormal(const std::string& line) {
  static const std::regex kAssignment(R"(^\s*(?:const\s+)?(?:vec3\s+)?([A-Za-z_][\w.]*)\s*=[^=])");
  std::smatch match;
  return std::regex_search(line, match, kAssignment) && isNormalName(lastPart(match[1]));
}

// Edges are carried to world space like directions, and their cross product is a normal: that is right.
bool isEdge(const SpirvModule& module, const SpirvInstruction& product) {
  const auto& users = module.users(product.result);
  return std::ranges::any_of(
      users, [&](std::size_t user) { return isExtended(module, module.instructions()[user], glsl450::kCross); });
}

// The line of the instruction, without a comment.
std::string sourceLine(const SpirvModule& module, const SpirvInstruction& instruction) {
  const shader::Place place = module.place(instruction);
  const std::string line(lineOf(module.source(place.file), place.line));
  return line.substr(0, line.find("//"));
}

bool isNormal(const SpirvModule& module, const SpirvInstruction& product, SpirvId direction) {
  const auto isLoad = [&](const SpirvInstruction& i) { return loadsNormal(module, i); };
  const auto leaves = [&](const SpirvInstruction& i) { return !keepsNormal(module, i); };
  if (dependsOn(module, direction, isLoad, leaves)) return true;
  const std::string line = sourceLine(module, product);
  return multipliesNormal(line) || (assignsNormal(line) && !isEdge(module, product));
}

}  // namespace

void checkNormals(const SpirvModule& module, Findings& findings) {
  for (const SpirvInstruction& product : module.instructions()) {
    if (product.op != Op::OpMatrixTimesVector || !isObjectToWorld(module, product.at(0))) continue;
    const SpirvId direction = directionOf(module, product.at(1));
    if (direction == 0 || !isNormal(module, product, direction)) continue;
    findings.add(
        "Q702", product,
        "a normal is multiplied by gl_ObjectToWorldEXT: under a scale that differs by axis it is no longer "
        "perpendicular to the surface",
        sourceLine(module, product).find("gl_ObjectToWorldEXT") != std::string::npos ? "gl_ObjectToWorldEXT" : "");
  }
}

}  // namespace quintet::program
