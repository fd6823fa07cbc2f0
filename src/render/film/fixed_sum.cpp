// SPDX-License-Identifier: Apache-2.0
#include "render/film/fixed_sum.h"

#include <bit>
#include <cmath>
#include <limits>

namespace quintet::render {
namespace {

__extension__ using Wide = unsigned __int128;

Wide toWide(const shared::FixedSum& sum) {
  Wide value = 0;
  for (int i = 3; i >= 0; --i) value = value << 32 | sum.word[i];
  return value;
}

shared::FixedSum toSum(Wide value) {
  shared::FixedSum sum{};
  for (shared::uint& word : sum.word) {
    word = static_cast<shared::uint>(value);
    value >>= 32;
  }
  return sum;
}

constexpr Wide kNotFinite = Wide{1} << 127;

}  // namespace

shared::FixedSum fixedFromFloat(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const int exponent = static_cast<int>(bits >> 23 & 0xFFu);
  if (exponent == 255) return toSum(kNotFinite);
  std::uint32_t mantissa = (bits & 0x7FFFFFu) | 0x800000u;
  int shift = exponent - 86;  // value = mantissa · 2^(exponent - 150)
  if (shift > 102) {
    mantissa = 0x800000u;
    shift = 103;
  }
  if (shift < -24) return {};
  if (shift < 0) {
    mantissa = (mantissa + (1u << (-shift - 1))) >> -shift;
    shift = 0;
  }
  const Wide magnitude = Wide{mantissa} << shift;
  return toSum(bits >> 31 ? -magnitude : magnitude);
}

bool isNotFinite(const shared::FixedSum& sum) { return toWide(sum) == kNotFinite; }

shared::FixedSum addFixed(shared::FixedSum a, const shared::FixedSum& b) {
  if (isNotFinite(a)) return a;
  if (isNotFinite(b)) return b;
  const Wide x = toWide(a), y = toWide(b), sum = x + y;
  // Overflow: both terms have the same sign and the sum has the opposite one.
  return toSum(((x ^ sum) & (y ^ sum)) >> 127 ? kNotFinite : sum);
}

double fixedToDouble(const shared::FixedSum& sum) {
  const Wide value = toWide(sum);
  if (value == kNotFinite) return std::numeric_limits<double>::quiet_NaN();
  const bool negative = value >> 127;
  const Wide magnitude = negative ? -value : value;
  const double result = std::ldexp(static_cast<double>(static_cast<std::uint64_t>(magnitude >> 64)), 64) +
                        static_cast<double>(static_cast<std::uint64_t>(magnitude));
  return std::ldexp(negative ? -result : result, -64);
}

}  // namespace quintet::render
