// The sRGB transfer functions (IEC 61966-2-1:1999, equations 5 to 8 with the rounded constants of its
// amendment 1). Only the curve: primaries are always Rec. 709's.
#ifndef QUINTET_IO_COLOR_H
#define QUINTET_IO_COLOR_H

#include <cmath>
#include <cstdint>

namespace quintet::io {

// Display value -> light, [0,1] -> [0,1]. Both curves continue beyond: linearly below 0, by the power above 1.
inline float linearFromSrgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

// Light -> display value.
inline float srgbFromLinear(float linear) {
  return linear <= 0.0031308f ? linear * 12.92f : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

// [0,1] -> 0 … 255, rounded to nearest; clamps, NaN gives 0.
inline std::uint8_t byteFromUnit(float value) {
  return static_cast<std::uint8_t>(!(value > 0.0f) ? 0.0f : value >= 1.0f ? 255.0f : value * 255.0f + 0.5f);
}

}  // namespace quintet::io
#endif
