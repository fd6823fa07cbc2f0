// SPDX-License-Identifier: Apache-2.0
// Host arithmetic of shared::FixedSum, a 128-bit fixed-point sum that does not depend on the order of its terms. The
// device counterpart is shaders/quintet/passes/fixed_sum.glsl.
#ifndef QUINTET_RENDER_FILM_FIXED_SUM_H
#define QUINTET_RENDER_FILM_FIXED_SUM_H

#include "quintet/shared/film.h"

namespace quintet::render {

// Rounds to the nearest multiple of 2^-64, with ties away from zero, and clamps to ±2^62. Infinity and NaN become the
// reserved value for which isNotFinite() holds.
shared::FixedSum fixedFromFloat(float value);

// Adds exactly and associatively. A sum beyond ±2^63 is not finite, and neither is a sum with a term that is not
// finite.
shared::FixedSum addFixed(shared::FixedSum a, const shared::FixedSum& b);

// Rounds to the nearest double; ties can go either way. Returns NaN for a sum that is not finite.
double fixedToDouble(const shared::FixedSum& sum);

bool isNotFinite(const shared::FixedSum& sum);

}  // namespace quintet::render
#endif
