// SPDX-License-Identifier: Apache-2.0
// Logs the operations whose result is not finite, although no operand is NaN. program::addValueProbes inserts this file
// before a stage and a new main() after it; spirv::addValueChecks then adds calls of valueResult1_ to valueResult4_ after the
// operations.
#ifndef QUINTET_VALUES_GLSL
#define QUINTET_VALUES_GLSL

#include "log.glsl"

const uint kMostValues_ = 16u;  // of an invocation of a stage
uint valueCount_ = 0u;

void valueFound_(const uint site, const bool isNan) {
  if (valueCount_++ >= kMostValues_) return;
  uint at = logBegin_(kLogValue, 2u);
  logWord_(at, site);
  logWord_(at, isNan ? 1u : 0u);
}

// `r`: result of operation number `site`, with the operands `a` and `b`. An infinite operand of an infinite result only passes
// the value on. Const parameters are values, not pointers, in SPIR-V.
#define VALUE_RESULT(name, Type, anyOf)                                              \
  void name(const uint site, const Type r, const Type a, const Type b) {             \
    const bool nan = anyOf(isnan(r)), infinite = anyOf(isinf(r));                    \
    if (!(nan || infinite) || anyOf(isnan(a)) || anyOf(isnan(b))) return;            \
    if (!nan && (anyOf(isinf(a)) || anyOf(isinf(b)))) return;                        \
    valueFound_(site, nan);                                                          \
  }
#define VALUE_ITSELF(x) (x)
VALUE_RESULT(valueResult1_, float, VALUE_ITSELF)
VALUE_RESULT(valueResult2_, vec2, any)
VALUE_RESULT(valueResult3_, vec3, any)
VALUE_RESULT(valueResult4_, vec4, any)

// The new main() calls this function, so that the compiler keeps the others. The call is removed.
void valuesKeep_() {
  valueResult1_(0u, 0.0, 0.0, 0.0);
  valueResult2_(0u, vec2(0.0), vec2(0.0), vec2(0.0));
  valueResult3_(0u, vec3(0.0), vec3(0.0), vec3(0.0));
  valueResult4_(0u, vec4(0.0), vec4(0.0), vec4(0.0));
}

#endif
