// SPDX-License-Identifier: Apache-2.0
// Sampling of an alias table (Walker 1974; Vose 1991; built by src/render/lights/alias_table.cpp).
#ifndef QUINTET_LIGHTS_ALIAS_GLSL
#define QUINTET_LIGHTS_ALIAS_GLSL

#include "../frame.glsl"

// Splits (u + extra · 2^-56) · count into its integer part and a fraction in units of 2^-32. The 24 bits of u are too few
// to address millions of entries evenly. `extra`, 32 independent random bits, appends to them. count ≤ 2^24.
uint splitIndex(float u, uint extra, uint count, out uint fraction) {
  uint whole, low, high, ignored, carry;
  umulExtended(uint(u * 16777216.0) << 8, count, whole, low);
  umulExtended(extra, count, high, ignored);
  fraction = uaddCarry(low, high << 8 | ignored >> 24, carry);
  return whole + carry;
}

// Converts 32 bits to a number in [0,1], to compare with AliasEntry::keep.
float fractionFloat(uint fraction) { return float(fraction) * (1.0 / 4294967296.0); }

// Returns `index` with the entry's probability `keep`, else its alias. `probability` is that of the result.
uint resolveAlias(AliasArray table, uint index, float fraction, out float probability) {
  const AliasEntry entry = table.at[index];
  const bool kept = fraction < entry.keep;
  if (!kept) index = entry.alias;
  probability = kept ? entry.probability : table.at[index].probability;
  return index;
}

#endif
