// SPDX-License-Identifier: Apache-2.0
// LDR-FLIP from the equations of Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", Proc. ACM
// Comput. Graph. Interact. Tech. 3(2), HPG 2020, https://doi.org/10.1145/3406183. Section and table numbers refer to
// it.
#include "io/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "base/math.h"
#include "base/parallel.h"

namespace quintet::io {
namespace {

// Sections 4.1.4 and 4.2: exponents and the remapping of color errors.
constexpr float kColorExponent = 0.7f;    // q_c
constexpr float kFeatureExponent = 0.5f;  // q_f
constexpr float kRemapFrom = 0.4f;        // p_c, fraction of the largest error
constexpr float kRemapTo = 0.95f;         // p_t
constexpr float kFeatureWidth = 0.082f;   // w, degrees

// One Gaussian a·sqrt(π/b)·exp(-π²x²/b) of a contrast sensitivity function; x is in degrees (Table 1).
struct Gaussian {
  float a;
  float b;
};
constexpr Gaussian kAchromatic{1.0f, 0.0047f};
constexpr Gaussian kRedGreen{1.0f, 0.0053f};
constexpr std::array<Gaussian, 2> kBlueYellow{{{34.1f, 0.04f}, {13.5f, 0.025f}}};

// Linear RGB to XYZ for the primaries and the white of Rec. 709 (x 0.3127, y 0.3290). The columns are R, G, B.
const mat3 kXyzFromRgb{0.4123908f, 0.2126390f, 0.0193308f, 0.3575843f, 0.7151687f,
                       0.1191948f, 0.1804808f, 0.0721923f, 0.9505322f};
const mat3 kRgbFromXyz = glm::inverse(kXyzFromRgb);
const vec3 kWhite = kXyzFromRgb * vec3(1.0f);

// YCxCz, a linear variant of CIELAB (section 4.1.1).
vec3 opponentFromRgb(const vec3& rgb) {
  const vec3 t = kXyzFromRgb * rgb / kWhite;
  return {116.0f * t.y - 16.0f, 500.0f * (t.x - t.y), 200.0f * (t.y - t.z)};
}

vec3 rgbFromOpponent(const vec3& opponent) {
  const float y = (opponent.x + 16.0f) / 116.0f;
  return kRgbFromXyz * (vec3(y + opponent.y / 500.0f, y, y - opponent.z / 200.0f) * kWhite);
}

// CIELAB (CIE 15:2004, 8.2.1).
vec3 labFromRgb(const vec3& rgb) {
  constexpr float kDelta = 6.0f / 29.0f;
  const auto f = [](float t) {
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
  };
  const vec3 t = kXyzFromRgb * rgb / kWhite;
  return {116.0f * f(t.y) - 16.0f, 500.0f * (f(t.x) - f(t.y)), 200.0f * (f(t.y) - f(t.z))};
}

// CIELAB with the Hunt effect: colors appear less saturated at low luminance (section 4.1.2).
vec3 huntFromRgb(const vec3& rgb) {
  const vec3 lab = labFromRgb(rgb);
  return {lab.x, 0.01f * lab.x * lab.y, 0.01f * lab.x * lab.z};
}

// HyAB distance (section 4.1.3), raised to q_c.
float colorDistance(const vec3& a, const vec3& b) {
  const float distance = std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
  return std::pow(distance, kColorExponent);
}

// ---- Separable convolution of planes; pixels outside repeat the border

struct Plane {
  Plane(std::size_t planeWidth, std::size_t planeHeight)
      : width(planeWidth), height(planeHeight), values(planeWidth * planeHeight) {}
  float* row(std::size_t y) { return values.data() + y * width; }
  const float* row(std::size_t y) const { return values.data() + y * width; }

  std::size_t width;
  std::size_t height;
  std::vector<float> values;
};

// 2 r + 1 weights; kernel[r] is the center: out(x) = Σ kernel[r + i] in(x + i).
using Kernel = std::vector<float>;

Plane convolveRows(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  const std::size_t radius = kernel.size() / 2;
  parallelFor(in.height, [&](std::size_t y) {
    std::vector<float> padded(in.width + 2 * radius);
    const float* from = in.row(y);
    std::fill_n(padded.begin(), radius, from[0]);
    std::copy_n(from, in.width, padded.data() + radius);
    std::fill_n(padded.end() - static_cast<std::ptrdiff_t>(radius), radius, from[in.width - 1]);
    float* to = out.row(y);
    for (std::size_t i = 0; i < kernel.size(); ++i)
      for (std::size_t x = 0; x < in.width; ++x) to[x] += kernel[i] * padded[x + i];
  });
  return out;
}

Plane convolveColumns(const Plane& in, const Kernel& kernel) {
  Plane out(in.width, in.height);
  const std::size_t radius = kernel.size() / 2;
  parallelFor(in.height, [&](std::size_t y) {
    float* to = out.row(y);
    for (std::size_t i = 0; i < kernel.size(); ++i) {
      const std::size_t below = y + i < radius ? 0 : y + i - radius;
      const float* from = in.row(std::min(below, in.height - 1));
      for (std::size_t x = 0; x < in.width; ++x) to[x] += kernel[i] * from[x];
    }
  });
  return out;
}

struct Opponent {
  Plane y, cx, cz;
};

Opponent opponentPlanes(const Image& rgb) {
  Opponent planes{{rgb.width, rgb.height}, {rgb.width, rgb.height}, {rgb.width, rgb.height}};
  const std::span<const float> samples = rgb.samples<float>();
  parallelFor(rgb.height, [&](std::size_t row) {
    for (std::size_t i = row * rgb.width; i < (row + 1) * rgb.width; ++i) {
      const vec3 value = opponentFromRgb({samples[3 * i], samples[3 * i + 1], samples[3 * i + 2]});
      planes.y.values[i] = value.x;
      planes.cx.values[i] = value.y;
      planes.cz.values[i] = value.z;
    }
  });
  return planes;
}

// ---- Color difference after the contrast sensitivity functions (section 4.1)

Kernel gaussianKernel(float b, std::size_t radius, float pixelsPerDegree, float& sum) {
  Kernel kernel(2 * radius + 1);
  sum = 0.0f;
  for (std::size_t i = 0; i < kernel.size(); ++i) {
    const float x = (static_cast<float>(i) - static_cast<float>(radius)) / pixelsPerDegree;
    sum += kernel[i] = std::exp(-kPi * kPi * x * x / b);
  }
  for (float& weight : kernel) weight /= sum;
  return kernel;
}

// Applies the Gaussians one by one, because each of them is separable and their sum is not.
Plane filterBySensitivity(const Plane& plane, std::span<const Gaussian> gaussians, float pixelsPerDegree) {
  // 3 σ of the widest Gaussian of all three channels.
  const float sigma = std::sqrt(kBlueYellow[0].b / (2.0f * kPi * kPi));
  const auto radius = static_cast<std::size_t>(std::ceil(3.0f * sigma * pixelsPerDegree));
  Plane result(plane.width, plane.height);
  float total = 0.0f;
  for (const auto& [a, b] : gaussians) {
    float sum = 0.0f;
    const Kernel kernel = gaussianKernel(b, radius, pixelsPerDegree, sum);
    const float weight = a * std::sqrt(kPi / b) * sum * sum;
    const Plane part = convolveColumns(convolveRows(plane, kernel), kernel);
    for (std::size_t i = 0; i < result.values.size(); ++i) result.values[i] += weight * part.values[i];
    total += weight;
  }
  for (float& value : result.values) value /= total;
  return result;
}

void filterBySensitivity(Opponent& planes, float pixelsPerDegree) {
  planes.y = filterBySensitivity(planes.y, {&kAchromatic, 1}, pixelsPerDegree);
  planes.cx = filterBySensitivity(planes.cx, {&kRedGreen, 1}, pixelsPerDegree);
  planes.cz = filterBySensitivity(planes.cz, kBlueYellow, pixelsPerDegree);
}

vec3 huntAt(const Opponent& planes, std::size_t i) {
  const vec3 rgb = rgbFromOpponent({planes.y.values[i], planes.cx.values[i], planes.cz.values[i]});
  return huntFromRgb(glm::clamp(rgb, 0.0f, 1.0f));
}

// Maps the largest error, between green and blue, to 1; small errors get most of the range (section 4.1.4).
float remapColorError(float error, float largest) {
  const float knee = kRemapFrom * largest;
  if (error < knee) return kRemapTo / knee * error;
  return kRemapTo + (error - knee) / (largest - knee) * (1.0f - kRemapTo);
}

// ---- Feature difference: edges and points in the achromatic channel (section 4.2)

// The Gaussian or its first or second derivative. The positive weights sum to 1, the negative ones to -1.
Kernel featureKernel(int derivative, float pixelsPerDegree) {
  const float sigma = 0.5f * kFeatureWidth * pixelsPerDegree;
  const auto radius = static_cast<std::size_t>(std::ceil(3.0f * sigma));
  Kernel kernel(2 * radius + 1);
  float positive = 0.0f;
  float negative = 0.0f;
  for (std::size_t i = 0; i < kernel.size(); ++i) {
    const float x = static_cast<float>(i) - static_cast<float>(radius);
    const float factor = derivative == 0 ? 1.0f : derivative == 1 ? -x : x * x / (sigma * sigma) - 1.0f;
    kernel[i] = factor * std::exp(-x * x / (2.0f * sigma * sigma));
    (kernel[i] > 0.0f ? positive : negative) += std::abs(kernel[i]);
  }
  for (float& weight : kernel) weight /= weight > 0.0f ? positive : std::max(negative, 1e-30f);
  return kernel;
}

struct Features {
  Plane edges;   // magnitude of the gradient
  Plane points;  // magnitude of the second derivatives
};

Features findFeatures(Plane y, float pixelsPerDegree) {
  for (float& value : y.values) value = (value + 16.0f) / 116.0f;
  const Kernel smooth = featureKernel(0, pixelsPerDegree);
  const Plane smoothRows = convolveRows(y, smooth);
  const auto magnitude = [&](int derivative) {
    const Kernel kernel = featureKernel(derivative, pixelsPerDegree);
    Plane result = convolveColumns(convolveRows(y, kernel), smooth);
    const Plane vertical = convolveColumns(smoothRows, kernel);
    for (std::size_t i = 0; i < result.values.size(); ++i)
      result.values[i] = std::sqrt(result.values[i] * result.values[i] + vertical.values[i] * vertical.values[i]);
    return result;
  };
  return {magnitude(1), magnitude(2)};
}

}  // namespace

Image flipOfDisplayable(const Image& a, const Image& b, float pixelsPerDegree) {
  Opponent planesA = opponentPlanes(a);
  Opponent planesB = opponentPlanes(b);
  const Features featuresA = findFeatures(planesA.y, pixelsPerDegree);
  const Features featuresB = findFeatures(planesB.y, pixelsPerDegree);
  filterBySensitivity(planesA, pixelsPerDegree);
  filterBySensitivity(planesB, pixelsPerDegree);

  const float largest = colorDistance(huntFromRgb({0.0f, 1.0f, 0.0f}), huntFromRgb({0.0f, 0.0f, 1.0f}));
  Image map = makeImage(a.width, a.height, 1, PixelType::f32, ColorEncoding::linear);
  const std::span<float> out = map.samples<float>();
  parallelFor(a.height, [&](std::size_t row) {
    for (std::size_t i = row * a.width; i < (row + 1) * a.width; ++i) {
      const float color = remapColorError(colorDistance(huntAt(planesA, i), huntAt(planesB, i)), largest);
      const float feature = std::max(std::abs(featuresA.edges.values[i] - featuresB.edges.values[i]),
                                     std::abs(featuresA.points.values[i] - featuresB.points.values[i]));
      const float featureError = std::pow(feature / std::numbers::sqrt2_v<float>, kFeatureExponent);
      out[i] = std::clamp(std::pow(color, 1.0f - featureError), 0.0f, 1.0f);
    }
  });
  return map;
}

}  // namespace quintet::io
