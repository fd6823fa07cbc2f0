// SPDX-License-Identifier: Apache-2.0
// Arithmetic of FixedSum (quintet/shared/film.h); src/render/film/fixed_sum.h does the same on the host.
#ifndef QUINTET_PASSES_FIXED_SUM_GLSL
#define QUINTET_PASSES_FIXED_SUM_GLSL

#include "../shared/film.h"

const float kFixedLimit = 4611686018427387904.0;  // 2^62

// Rounds to the nearest multiple of 2^-64 and clamps to ±2^62. Inf and NaN give the value that marks "not finite".
FixedSum fixedFromFloat(float value) {
  const uint bits = floatBitsToUint(value);
  const uint exponent = (bits >> 23) & 0xFFu;
  FixedSum sum = FixedSum(uint[4](0u, 0u, 0u, 0u));
  if (exponent == 255u) {
    sum.word[3] = kNotFiniteWord;
    return sum;
  }
  uint mantissa = (bits & 0x7FFFFFu) | 0x800000u;
  // value = mantissa · 2^(exponent - 150), so in units of 2^-64 it is mantissa · 2^shift.
  int shift = int(exponent) - 86;
  if (shift > 102) {
    mantissa = 0x800000u;
    shift = 103;
  }
  if (shift < 0) {
    if (shift < -24) return sum;
    mantissa = (mantissa + (1u << uint(-shift - 1))) >> uint(-shift);
    shift = 0;
  }
  const uint first = uint(shift) >> 5;
  const uint offset = uint(shift) & 31u;
  const uint low = mantissa << offset;
  const uint high = offset > 8u ? mantissa >> (32u - offset) : 0u;
  for (uint i = 0u; i < 4u; ++i) sum.word[i] = i == first ? low : i == first + 1u ? high : 0u;
  if ((bits >> 31) == 0u) return sum;
  uint carry = 1u;
  for (uint i = 0u; i < 4u; ++i) sum.word[i] = uaddCarry(~sum.word[i], carry, carry);
  return sum;
}

bool isNotFinite(FixedSum sum) { return sum.word[3] == kNotFiniteWord && (sum.word[0] | sum.word[1] | sum.word[2]) == 0u; }

FixedSum addFixed(FixedSum a, FixedSum b) {
  if (isNotFinite(a)) return a;
  if (isNotFinite(b)) return b;
  const uint high = a.word[3];
  uint carry = 0u;
  for (uint i = 0u; i < 4u; ++i) {
    uint first, second;
    a.word[i] = uaddCarry(a.word[i], carry, first);
    a.word[i] = uaddCarry(a.word[i], b.word[i], second);
    carry = first + second;
  }
  // Overflow: both terms have the same sign and the sum has the opposite one.
  if ((((high ^ a.word[3]) & (b.word[3] ^ a.word[3])) >> 31) != 0u) return FixedSum(uint[4](0u, 0u, 0u, kNotFiniteWord));
  return a;
}

// With a relative error below 2^-21; NaN if a term was not finite.
float floatFromFixed(FixedSum sum) {
  if (isNotFinite(sum)) return uintBitsToFloat(0x7FC00000u);
  const bool negative = (sum.word[3] >> 31) != 0u;
  uint carry = 1u;
  if (negative)
    for (uint i = 0u; i < 4u; ++i) sum.word[i] = uaddCarry(~sum.word[i], carry, carry);
  const float word = 4294967296.0;  // 2^32
  float value = 0.0;
  for (uint i = 0u; i < 4u; ++i) value = float(sum.word[i]) + value / word;
  return (negative ? -word : word) * value;
}

#endif
