// SPDX-License-Identifier: Apache-2.0
// The sRGB transfer functions (IEC 61966-2-1:1999, equations 5 to 8 with the rounded constants of amendment 1). The
// primaries are always those of Rec. 709.
#ifndef QUINTET_IO_COLOR_H
#define QUINTET_IO_COLOR_H

#include <cmath>
#include <cstdint>
#include <limits>

namespace quintet::io {

// Decodes a display value: [0,1] -> [0,1]. Both functions are also defined outside: linear below 0, the power above 1.
inline float linearFromSrgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

// Encodes linear light as a display value.
inline float srgbFromLinear(float linear) {
  return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

// Converts [0,1] to 0 … 255 (uint8_t) or 0 … 65535 (uint16_t), rounded to nearest. Values outside are clamped; NaN becomes
// 0.
template <class T>
T integerFromUnit(float value) {
  constexpr float kMax = static_cast<float>(std::numeric_limits<T>::max());
  return static_cast<T>(!(value > 0.0f) ? 0.0f : value >= 1.0f ? kMax : value * kMax + 0.5f);
}
inline std::uint8_t byteFromUnit(float value) { return integerFromUnit<std::uint8_t>(value); }

}  // namespace quintet::io
#endif
