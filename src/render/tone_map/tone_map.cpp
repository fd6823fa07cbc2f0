// SPDX-License-Identifier: Apache-2.0
#include "render/tone_map/tone_map.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "io/color.h"

namespace quintet::render {
namespace {

constexpr std::array<std::pair<const char*, ToneMap>, 4> kNames{
    {{"linear", ToneMap::linear}, {"aces", ToneMap::aces}, {"agx", ToneMap::agx}, {"neutral", ToneMap::neutral}}};

// Largest input of the curves. All of them have reached their end far below, and its square still fits a float.
constexpr float kBrightest = 1e8f;

// ACES reference rendering and output transform, as fitted by Stephen Hill (2015, BakingLab, ACES.hlsl). Scaled by
// 1/0.6 as in three.js, so that mid grays have about the same brightness as with the other curves.
vec3 aces(vec3 color) {
  // sRGB primaries to AP1 with RRT_SAT, and back with ODT_SAT, in columns.
  constexpr mat3 kInput{0.59719f, 0.07600f, 0.02840f, 0.35458f, 0.90834f, 0.13383f, 0.04823f, 0.01566f, 0.83777f};
  constexpr mat3 kOutput{1.60475f,  -0.10208f, -0.00327f, -0.53108f, 1.10813f,
                         -0.07276f, -0.07367f, -0.00605f, 1.07602f};
  const vec3 v = kInput * (color / 0.6f);
  const vec3 a = v * (v + 0.0245786f) - 0.000090537f;
  const vec3 b = v * (0.983729f * v + 0.4329510f) + 0.238081f;
  return kOutput * (a / b);
}

// AgX base look by Troy Sobotka (2022), with the matrices and the sixth-order fit of its sigmoid by Benjamin Wrensch
// (2023, iolite-engine.com/blog_posts/minimal_agx_implementation). The curve is made for a display of gamma 2.2, which
// is undone here because the sRGB curve follows.
vec3 agx(vec3 color) {
  constexpr mat3 kInset{0.842479062253094f,  0.0423282422610123f, 0.0423756549057051f,
                        0.0784335999999992f, 0.878468636469772f,  0.0784336f,
                        0.0792237451477643f, 0.0791661274605434f, 0.879142973793104f};
  constexpr mat3 kOutset{1.19687900512017f,    -0.0528968517574562f, -0.0529716355144438f,
                         -0.0980208811401368f, 1.15190312990417f,    -0.0980434501171241f,
                         -0.0990297440797205f, -0.0989611768448433f, 1.15107367264116f};
  constexpr float kMinEv = -12.47393f;
  constexpr float kMaxEv = 4.026069f;
  const vec3 light = glm::max(kInset * color, vec3(1e-10f));
  const vec3 x = glm::clamp((glm::log2(light) - kMinEv) / (kMaxEv - kMinEv), 0.0f, 1.0f);
  const vec3 x2 = x * x;
  const vec3 x4 = x2 * x2;
  const vec3 curve =
      15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x + 0.4298f * x2 + 0.1191f * x - 0.00232f;
  return glm::pow(glm::max(kOutset * curve, vec3(0.0f)), vec3(2.2f));
}

// Khronos PBR Neutral (2024), github.com/KhronosGroup/ToneMapping/tree/main/PBR_Neutral: keeps base colors up to 0.8,
// except for the Fresnel offset, and compresses brighter colors.
vec3 neutral(vec3 color) {
  constexpr float kFresnel = 0.04f;
  constexpr float kStart = 0.8f - kFresnel;
  constexpr float kDesaturation = 0.15f;
  const float least = std::min({color.r, color.g, color.b});
  color -= least < 2.0f * kFresnel ? least - least * least / (4.0f * kFresnel) : kFresnel;
  const float peak = std::max({color.r, color.g, color.b});
  if (peak < kStart) return color;
  constexpr float kRange = 1.0f - kStart;  // of compressed values
  const float newPeak = 1.0f - kRange * kRange / (peak + kRange - kStart);
  const float desaturation = 1.0f - 1.0f / (kDesaturation * (peak - newPeak) + 1.0f);
  return glm::mix(color * (newPeak / peak), vec3(newPeak), desaturation);
}

// Replaces NaN and negative values by 0, and clamps to kBrightest.
vec3 clean(const vec3& color) {
  vec3 result;
  for (glm::length_t i = 0; i < 3; ++i) result[i] = color[i] > 0.0f ? std::min(color[i], kBrightest) : 0.0f;
  return result;
}

template <class T>
io::Image encodeDisplay(const io::Image& image, ToneMap operation, float exposure, bool opaque) {
  assert(image.channels == 4 && image.type == io::PixelType::f32);
  constexpr io::PixelType kType = sizeof(T) == 2 ? io::PixelType::u16 : io::PixelType::u8;
  const std::uint32_t channels = opaque ? 3 : 4;
  io::Image result = io::makeImage(image.width, image.height, channels, kType, io::ColorEncoding::sRgb);
  const auto source = image.samples<float>();
  const auto target = result.samples<T>();
  const float scale = std::exp2(exposure);
  parallelFor(image.height, [&](std::size_t y) {
    const float* in = source.data() + y * image.width * 4;
    T* out = target.data() + y * image.width * channels;
    for (std::uint32_t x = 0; x < image.width; ++x, in += 4, out += channels) {
      const float alpha = in[3];
      const vec3 straight = alpha > 0.0f ? vec3(in[0], in[1], in[2]) / alpha : vec3(0.0f);
      const vec3 display = toneMap(operation, straight * scale);
      for (glm::length_t i = 0; i < 3; ++i) out[i] = io::integerFromUnit<T>(io::srgbFromLinear(display[i]));
      if (!opaque) out[3] = io::integerFromUnit<T>(alpha);
    }
  });
  return result;
}

}  // namespace

std::optional<ToneMap> toneMapByName(const std::string& name) {
  for (const auto& [known, value] : kNames)
    if (name == known) return value;
  return std::nullopt;
}

std::vector<std::string> toneMapNames() {
  std::vector<std::string> names;
  for (const auto& entry : kNames) names.emplace_back(entry.first);
  return names;
}

ToneMap defaultToneMap(program::OutputKind kind) {
  return kind == program::OutputKind::color ? ToneMap::neutral : ToneMap::linear;
}

vec3 toneMap(ToneMap operation, vec3 color) {
  color = clean(color);
  switch (operation) {
    case ToneMap::linear: break;
    case ToneMap::aces: color = aces(color); break;
    case ToneMap::agx: color = agx(color); break;
    case ToneMap::neutral: color = neutral(color); break;
  }
  return glm::clamp(color, 0.0f, 1.0f);
}

io::Image toDisplay(const io::Image& image, ToneMap operation, float exposure, bool opaque, unsigned bits) {
  return bits == 16 ? encodeDisplay<std::uint16_t>(image, operation, exposure, opaque)
                    : encodeDisplay<std::uint8_t>(image, operation, exposure, opaque);
}

void decodeDisplay(io::Image& image, bool transparent) {
  const std::span<float> values = image.samples<float>();
  parallelRanges(values.size() / 4, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = 4 * first; i < 4 * end; i += 4) {
      const float alpha = transparent ? std::clamp(values[i + 3], 0.0f, 1.0f) : 1.0f;
      for (std::size_t c = i; c < i + 3; ++c) values[c] = alpha * io::linearFromSrgb(values[c]);
      values[i + 3] = alpha;
    }
  });
}

}  // namespace quintet::render
