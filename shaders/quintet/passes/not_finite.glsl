// SPDX-License-Identifier: Apache-2.0
// Finds NaN and infinity in the bits of floats, because a compiler can assume that floats are finite.
#ifndef QUINTET_PASSES_NOT_FINITE_GLSL
#define QUINTET_PASSES_NOT_FINITE_GLSL

bool hasInfOrNan(uvec4 bits) { return any(equal(bits & 0x7F800000u, uvec4(0x7F800000u))); }

#endif
