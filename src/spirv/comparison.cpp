// SPDX-License-Identifier: Apache-2.0
#include "spirv/comparison.h"

#include <cmath>

namespace quintet::spirv {

std::optional<Comparison> comparisonOf(spv::Op op) {
  switch (op) {
    case spv::Op::OpIEqual:
    case spv::Op::OpFOrdEqual:
    case spv::Op::OpLogicalEqual: return Comparison{Relation::equal};
    case spv::Op::OpFUnordEqual: return Comparison{Relation::equal, false, true};
    case spv::Op::OpINotEqual:
    case spv::Op::OpFOrdNotEqual:
    case spv::Op::OpLogicalNotEqual: return Comparison{Relation::notEqual};
    case spv::Op::OpFUnordNotEqual: return Comparison{Relation::notEqual, false, true};
    case spv::Op::OpULessThan: return Comparison{Relation::less, true};
    case spv::Op::OpSLessThan:
    case spv::Op::OpFOrdLessThan: return Comparison{Relation::less};
    case spv::Op::OpFUnordLessThan: return Comparison{Relation::less, false, true};
    case spv::Op::OpULessThanEqual: return Comparison{Relation::lessOrEqual, true};
    case spv::Op::OpSLessThanEqual:
    case spv::Op::OpFOrdLessThanEqual: return Comparison{Relation::lessOrEqual};
    case spv::Op::OpFUnordLessThanEqual: return Comparison{Relation::lessOrEqual, false, true};
    case spv::Op::OpUGreaterThan: return Comparison{Relation::greater, true};
    case spv::Op::OpSGreaterThan:
    case spv::Op::OpFOrdGreaterThan: return Comparison{Relation::greater};
    case spv::Op::OpFUnordGreaterThan: return Comparison{Relation::greater, false, true};
    case spv::Op::OpUGreaterThanEqual: return Comparison{Relation::greaterOrEqual, true};
    case spv::Op::OpSGreaterThanEqual:
    case spv::Op::OpFOrdGreaterThanEqual: return Comparison{Relation::greaterOrEqual};
    case spv::Op::OpFUnordGreaterThanEqual: return Comparison{Relation::greaterOrEqual, false, true};
    default: return {};
  }
}

bool hasSignOf(const Comparison& comparison, const Type& type) {
  const bool ordered = comparison.relation != Relation::equal && comparison.relation != Relation::notEqual;
  return type.kind != Type::Kind::integer || !ordered || comparison.isUnsigned != type.isSigned;
}

Relation negated(Relation relation) {
  switch (relation) {
    case Relation::equal: return Relation::notEqual;
    case Relation::notEqual: return Relation::equal;
    case Relation::less: return Relation::greaterOrEqual;
    case Relation::lessOrEqual: return Relation::greater;
    case Relation::greater: return Relation::lessOrEqual;
    case Relation::greaterOrEqual: break;
  }
  return Relation::less;
}

Relation mirrored(Relation relation) {
  switch (relation) {
    case Relation::less: return Relation::greater;
    case Relation::lessOrEqual: return Relation::greaterOrEqual;
    case Relation::greater: return Relation::less;
    case Relation::greaterOrEqual: return Relation::lessOrEqual;
    default: return relation;
  }
}

bool holds(const Comparison& comparison, double a, double b) {
  if (std::isnan(a) || std::isnan(b)) return comparison.unordered;
  switch (comparison.relation) {
    case Relation::equal: return a == b;
    case Relation::notEqual: return a != b;
    case Relation::less: return a < b;
    case Relation::lessOrEqual: return a <= b;
    case Relation::greater: return a > b;
    case Relation::greaterOrEqual: break;
  }
  return a >= b;
}

}  // namespace quintet::spirv
