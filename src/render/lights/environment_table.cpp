// SPDX-License-Identifier: Apache-2.0
#include "render/lights/environment_table.h"

#include <algorithm>
#include <functional>

#include "base/parallel.h"
#include "render/lights/alias_table.h"
#include "render/lights/luminance.h"

namespace quintet::render {
namespace {

constexpr double kLeastAboveMean = 0.01;  // of the integral; less is hardly more than rounding

constexpr std::size_t kRowsPerTask = 16;

void forRows(std::size_t count, const std::function<void(std::size_t)>& body) {
  parallelFor((count + kRowsPerTask - 1) / kRowsPerTask, [&](std::size_t task) {
    for (std::size_t y = task * kRowsPerTask; y < std::min(count, (task + 1) * kRowsPerTask); ++y) body(y);
  });
}

std::vector<float> texelLuminance(const io::Image& image) {
  std::vector<float> result(image.pixelCount());
  const std::span<const float> samples = image.samples<float>();
  forRows(image.height, [&](std::size_t y) {
    for (std::size_t i = y * image.width; i < (y + 1) * image.width; ++i) {
      const float* p = &samples[i * image.channels];
      const vec3 color = image.channels < 3 ? vec3(p[0]) : vec3(p[0], p[1], p[2]);
      result[i] = lightLuminance(color);
    }
  });
  return result;
}

// Returns the mean of the bilinear interpolant over the square of each texel. Along each axis the texel has the mean
// weight 3/4, and each neighbor ∫ t dt over [0, 1/2] = 1/8.
std::vector<float> meanOfInterpolant(const std::vector<float>& texels, std::size_t width, std::size_t height) {
  std::vector<float> result(texels.size());
  forRows(height, [&](std::size_t y) {
    const float* above = &texels[(y > 0 ? y - 1 : 0) * width];
    const float* here = &texels[y * width];
    const float* below = &texels[std::min(y + 1, height - 1) * width];
    const auto column = [&](std::size_t x) { return 0.125f * above[x] + 0.75f * here[x] + 0.125f * below[x]; };
    float left = column(width - 1);
    float middle = column(0);
    for (std::size_t x = 0; x < width; ++x) {
      const float right = column(x + 1 < width ? x + 1 : 0);
      result[y * width + x] = 0.125f * left + 0.75f * middle + 0.125f * right;
      left = middle;
      middle = right;
    }
  });
  return result;
}

// Calls body(i, share) for each of `from` cells that overlaps cell `index` of `to` cells. The shares sum to 1.
template <class Body>
void forOverlaps(std::size_t index, std::size_t to, std::size_t from, const Body& body) {
  const std::size_t begin = index * from;  // in units of 1/to of a source cell
  const std::size_t end = begin + from;
  for (std::size_t i = begin / to; i * to < end; ++i) {
    const std::size_t covered = std::min(end, (i + 1) * to) - std::max(begin, i * to);
    body(i, static_cast<float>(covered) / static_cast<float>(from));
  }
}

std::vector<float> coarsen(const std::vector<float>& cells, uvec2 from, uvec2 to) {
  std::vector<float> result(static_cast<std::size_t>(to.x) * to.y, 0.0f);
  forRows(to.y, [&](std::size_t y) {
    float* out = &result[y * to.x];
    forOverlaps(y, to.y, from.y, [&](std::size_t row, float share) {
      for (std::size_t x = 0; x < to.x; ++x) {
        float sum = 0.0f;
        forOverlaps(x, to.x, from.x, [&](std::size_t i, float part) { sum += part * cells[row * from.x + i]; });
        out[x] += share * sum;
      }
    });
  });
  return result;
}

// The solid angle of a cell: 2π/width · (cos θ_top - cos θ_bottom), as in quintet/lights/environment.glsl.
double cellAngle(std::size_t row, const uvec2& size) {
  const double halfStep = 0.5 * glm::pi<double>() / size.y;
  const double middle = (2.0 * static_cast<double>(row) + 1.0) * halfStep;
  return 4.0 * glm::pi<double>() / size.x * std::sin(middle) * std::sin(halfStep);
}

// `weights`: luminance times solid angle of each cell, with the sum `integral`.
std::vector<shared::AliasEntry> balancedTable(std::vector<float> weights, const uvec2& size, double integral) {
  const double mean = integral / (4.0 * glm::pi<double>());
  double above = 0.0;
  for (std::size_t y = 0; y < size.y; ++y) {
    const auto part = static_cast<float>(mean * cellAngle(y, size));
    for (float& w : std::span(&weights[y * size.x], size.x)) {
      w = std::max(w - part, 0.0f);
      above += w;
    }
  }
  return above > kLeastAboveMean * integral ? buildAliasTable(weights) : std::vector<shared::AliasEntry>{};
}

}  // namespace

EnvironmentTable buildEnvironmentTable(const scene::Environment& environment) {
  EnvironmentTable table;
  uvec2 size(1);
  std::vector<float> weights;
  if (environment.image.empty()) {
    weights = {lightLuminance(environment.constant)};
  } else {
    const io::Image converted =
        environment.image.type == io::PixelType::f32 ? io::Image{} : io::toFloat(environment.image);
    const io::Image& image = converted.empty() ? environment.image : converted;
    const uvec2 full(image.width, image.height);
    weights = meanOfInterpolant(texelLuminance(image), full.x, full.y);
    size = glm::min(full, uvec2(kMaxEnvironmentTableWidth, kMaxEnvironmentTableHeight));
    if (size != full) weights = coarsen(weights, full, size);
  }
  for (std::size_t y = 0; y < size.y; ++y) {
    const double angle = cellAngle(y, size);
    const std::span<float> row(&weights[y * size.x], size.x);
    double sum = 0.0;
    for (float& w : row) {
      sum += w;
      w *= static_cast<float>(angle);
    }
    table.integral += angle * sum;
  }
  table.unscaledIntegral = table.integral;
  table.integral *= environment.intensity;
  if (!(environment.intensity > 0.0f) && environment.values.empty()) return {};
  table.entries = buildAliasTable(weights);
  if (table.entries.empty()) return {};
  table.balanced = balancedTable(std::move(weights), size, table.unscaledIntegral);
  table.width = size.x;
  table.height = size.y;
  return table;
}

}  // namespace quintet::render
