// SPDX-License-Identifier: Apache-2.0
// Q514: tmax is the length of the ray direction. The unit of t is the length of the direction, so the ray is too long
// or too short unless the direction is normalized.
#include <spirv/unified1/GLSL.std.450.h>

#include "check/rules/rules.h"
#include "check/rules/user_location.h"
#include "spirv/same_value.h"
#include "spirv/trace_instruction.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;

// True if a = b or a = -b.
bool sameLine(const spirv::Module& module, Id a, Id b) {
  if (spirv::sameValue(module, a, b)) return true;
  const spirv::Instruction* left = module.definition(a);
  const spirv::Instruction* right = module.definition(b);
  if (!left || !right) return false;
  if (left->op == Op::OpFNegate && spirv::sameValue(module, left->at(0), b)) return true;
  if (right->op == Op::OpFNegate && spirv::sameValue(module, right->at(0), a)) return true;
  return left->op == Op::OpFSub && right->op == Op::OpFSub && spirv::sameValue(module, left->at(0), right->at(1)) &&
         spirv::sameValue(module, left->at(1), right->at(0));
}

// True if the instruction is the length of the direction, up to its sign: length(d), distance(a, b), sqrt(dot(d, d)).
bool isLengthOf(const spirv::Module& module, const spirv::Instruction& i, Id direction) {
  if (spirv::isExtended(module, i, GLSLstd450Length)) return sameLine(module, i.at(2), direction);
  if (spirv::isExtended(module, i, GLSLstd450Sqrt)) {
    const spirv::Instruction* square = module.definition(i.at(2));
    return square && square->op == Op::OpDot && square->at(0) == square->at(1) &&
           sameLine(module, square->at(0), direction);
  }
  if (!spirv::isExtended(module, i, GLSLstd450Distance)) return false;
  const spirv::Instruction* difference = module.definition(direction);
  if (!difference || difference->op != Op::OpFSub) return false;
  const auto matches = [&](Id a, Id b) {
    return spirv::sameValue(module, difference->at(0), a) && spirv::sameValue(module, difference->at(1), b);
  };
  return matches(i.at(2), i.at(3)) || matches(i.at(3), i.at(2));
}

// True for instructions whose result is a length if an operand is: length - epsilon, 0.999 * length, min(length, far).
bool keepsUnit(const spirv::Module& module, const spirv::Instruction& i) {
  switch (i.op) {
    case Op::OpFAdd:
    case Op::OpFSub:
    case Op::OpPhi:
    case Op::OpSelect:
    case Op::OpCopyObject:
    case Op::OpLoad:
    case Op::OpStore: return true;
    case Op::OpFMul: return module.isConstant(i.at(0)) || module.isConstant(i.at(1));
    default:
      return spirv::isExtended(module, i, GLSLstd450FMin) || spirv::isExtended(module, i, GLSLstd450FMax) ||
             spirv::isExtended(module, i, GLSLstd450NMin) || spirv::isExtended(module, i, GLSLstd450NMax);
  }
}

}  // namespace

void checkRayLengths(const spirv::Module& module, Report& report) {
  for (const spirv::Instruction& trace : module.instructions()) {
    const auto ray = spirv::rayOperands(trace);
    if (!ray) continue;
    const spirv::Instruction* length = spirv::findInSlice(
        module, ray->tmax, [&](const spirv::Instruction& i) { return isLengthOf(module, i, ray->direction); },
        [&](const spirv::Instruction& i) { return !keepsUnit(module, i); });
    if (!length) continue;
    SourceLocation location = spirv::traceLocation(module, trace);
    if (isLibrary(location)) location = module.location(*length);
    report.addOncePerLine("Q514", location,
                          "tmax is the length of the direction, but t is in units of that length, so the ray ends at "
                          "the square of the length");
  }
}

}  // namespace quintet::check
