// Sums that do not depend on the order of their terms (shared::FixedSum), on the host: what a film is read, stored and
// merged with. The device's side is shaders/quintet/passes/fixed_sum.glsl.
#ifndef QUINTET_RENDER_FIXED_SUM_H
#define QUINTET_RENDER_FIXED_SUM_H

#include "quintet/shared/film.h"

namespace quintet::render {

// To the nearest unit of 2^-64, halves away from zero; beyond ±2^62: that. Not finite: the value that says so.
shared::FixedSum fixedFromFloat(float value);

// Exact and associative within ±2^63; beyond: not finite. A sum that is not finite stays so.
shared::FixedSum addFixed(shared::FixedSum a, const shared::FixedSum& b);

// To the nearest double, halves up or down; NaN where a term was not finite.
double fixedToDouble(const shared::FixedSum& sum);

bool isNotFinite(const shared::FixedSum& sum);

}  // namespace quintet::render
#endif
