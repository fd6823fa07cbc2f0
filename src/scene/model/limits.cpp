// SPDX-License-Identifier: Apache-2.0
#include "scene/model/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "base/error.h"
#include "base/parallel.h"
#include "base/plural.h"
#include "scene/model/mesh_bounds.h"

namespace quintet::scene {

bool isWithinLimits(const vec3& point) {
  return std::abs(point.x) <= kMaxCoordinate && std::abs(point.y) <= kMaxCoordinate &&
         std::abs(point.z) <= kMaxCoordinate;
}

bool isWithinLimits(const mat4& transform) {
  for (std::size_t column = 0; column < 4; ++column)
    if (!isWithinLimits(vec3(transform[column]))) return false;
  return true;
}

bool isWithinLimits(const Bounds3& bounds) {
  return bounds.empty() || (isWithinLimits(bounds.min) && isWithinLimits(bounds.max));
}

void checkExtent(const Scene& scene, const Bounds3& bounds) {
  if (isWithinLimits(bounds)) return;
  for (std::size_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    if (isWithinLimits(meshBounds(scene.meshes[static_cast<std::size_t>(instance.mesh)], instance.worldFromObject)))
      continue;
    throw Error(fmt::format("scene: instances[{}]{} extends more than {:g} m from the origin, the largest distance", i,
                            instance.name.empty() ? "" : " '" + instance.name + "'", kMaxCoordinate));
  }
}

std::string repairTexels(io::Image& image) {
  if (image.type != io::PixelType::f32) return {};
  const std::span<float> samples = image.samples<float>();
  const std::size_t channels = image.channels;
  std::atomic<std::size_t> count = 0, first = image.pixelCount();
  parallelRanges(image.pixelCount(), [&](std::size_t begin, std::size_t end) {
    std::size_t changed = 0;
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      bool valid = true;
      for (float& v : samples.subspan(pixel * channels, channels)) {
        if (std::abs(v) <= kMaxRadiance) continue;  // false for NaN
        valid = false;
        v = std::isnan(v) ? 0.0f : std::copysign(kMaxRadiance, v);
      }
      if (valid) continue;
      ++changed;
      for (std::size_t known = first; pixel < known && !first.compare_exchange_weak(known, pixel);) {
      }
    }
    count += changed;
  });
  if (count == 0) return {};
  return fmt::format(
      "{} {} NaN, infinite or above {:g}: NaN replaced by 0, other values clamped; {} ({}, {}), counted from the "
      "top left corner",
      counted(count.load(), "pixel"), nounFor(count.load(), "is", "are"), kMaxRadiance,
      count == 1 ? "it is at" : "the first is at", first % image.width, first / image.width);
}

}  // namespace quintet::scene
