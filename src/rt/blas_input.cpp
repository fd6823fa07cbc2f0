// SPDX-License-Identifier: Apache-2.0
#include "rt/blas_input.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/parallel.h"
#include "rt/spatial_order.h"

namespace quintet::rt {
namespace {

constexpr std::size_t kChunk = 32768;  // primitives per task

std::vector<Bounds3> boundsOf(const GeometryInput& input) {
  std::vector<Bounds3> bounds(primitiveCount(input));
  parallelRanges(bounds.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) bounds[k] = primitiveBounds(input, k);
  });
  return bounds;
}

// Returns the bounds of all primitives; no value if a primitive is inactive.
std::optional<Bounds3> wholeBounds(const GeometryInput& input) {
  const std::size_t count = primitiveCount(input);
  std::vector<Bounds3> parts((count + kChunk - 1) / kChunk);
  std::atomic<bool> active = true;
  parallelRanges(
      count,
      [&](std::size_t first, std::size_t last) {
        Bounds3& part = parts[first / kChunk];
        for (std::size_t k = first; k < last; ++k) {
          const Bounds3 bounds = primitiveBounds(input, k);
          if (bounds.empty()) active = false;
          part.extend(bounds);
        }
      },
      kChunk);
  if (!active) return {};
  Bounds3 whole;
  for (const Bounds3& part : parts) whole.extend(part);
  return whole;
}

// Removes empty bounds. Returns the indices of the others, or an empty list if all stay.
std::vector<std::uint32_t> keepActive(std::vector<Bounds3>& bounds) {
  std::vector<std::uint32_t> active;
  if (std::ranges::none_of(bounds, &Bounds3::empty)) return active;
  for (std::size_t k = 0; k < bounds.size(); ++k)
    if (!bounds[k].empty()) active.push_back(static_cast<std::uint32_t>(k));
  std::erase_if(bounds, [](const Bounds3& b) { return b.empty(); });
  return active;
}

bool isIdentity(const std::vector<std::uint32_t>& map) {
  for (std::size_t k = 0; k < map.size(); ++k)
    if (map[k] != k) return false;
  return true;
}

// The active primitives of all geometries, in their order.
struct Active {
  std::vector<Bounds3> bounds;
  std::vector<std::size_t> counts;                  // per geometry
  std::vector<std::vector<std::uint32_t>> indices;  // per geometry; empty means all
};

Active findActive(const BlasInput& input) {
  Active active;
  for (const GeometryInput& geometry : input.geometries) {
    std::vector<Bounds3> bounds = boundsOf(geometry);
    active.indices.push_back(keepActive(bounds));
    active.counts.push_back(bounds.size());
    if (active.bounds.empty()) {
      active.bounds = std::move(bounds);
    } else {
      active.bounds.insert(active.bounds.end(), bounds.begin(), bounds.end());
    }
  }
  return active;
}

// Returns the map of the geometry whose active primitives, listed by `active` (empty means all), have the positions
// [first, first + count) in `sorted`.
std::vector<std::uint32_t> orderedMap(const std::vector<std::uint32_t>& active, std::vector<std::uint32_t>& sorted,
                                      std::size_t first, std::size_t count) {
  // The common case of large inputs: one geometry without inactive primitives.
  if (count == sorted.size() && active.empty()) return std::move(sorted);
  std::vector<std::uint32_t> map(count);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t position = sorted[first + k] - first;
    map[k] = active.empty() ? static_cast<std::uint32_t>(position) : active[position];
  }
  return map;
}

// Returns all primitives in input order; no value if some are inactive.
std::optional<BlasData> asGiven(const BlasInput& input) {
  BlasData data;
  for (const GeometryInput& geometry : input.geometries) {
    const std::optional<Bounds3> bounds = wholeBounds(geometry);
    if (!bounds) return {};
    data.bounds.extend(*bounds);
    data.geometries.push_back(applyMap(geometry, {}, primitiveCount(geometry)));
  }
  return data;
}

}  // namespace

std::size_t primitiveCount(const GeometryInput& input) {
  return input.kind == GeometryKind::triangles ? input.triangles.size() : input.boxes.size();
}

Bounds3 primitiveBounds(const GeometryInput& input, std::size_t primitive) {
  Bounds3 bounds;
  if (input.kind == GeometryKind::boxes) {
    bounds = input.boxes[primitive];
    return isFinite(bounds.min) && isFinite(bounds.max) ? bounds : Bounds3{};
  }
  const uvec3& triangle = input.triangles[primitive];
  for (glm::length_t corner = 0; corner < 3; ++corner) {
    assert(triangle[corner] < input.positions.size());
    const vec3& position = input.positions[triangle[corner]];
    if (!isFinite(position)) return {};
    bounds.extend(position);
  }
  return bounds;
}

GeometryData applyMap(const GeometryInput& input, std::vector<std::uint32_t> map, std::size_t count) {
  GeometryData data{.input = input, .flags = 0, .map = std::move(map), .count = static_cast<std::uint32_t>(count)};
  if (input.opaque) data.flags |= VK_GEOMETRY_OPAQUE_BIT_KHR;
  if (input.singleAnyHit) data.flags |= VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR;
  return data;
}

VkDeviceSize GeometryData::primitiveBytes() const {
  return VkDeviceSize{count} * (input.kind == GeometryKind::triangles ? sizeof(uvec3) : sizeof(Bounds3));
}

void GeometryData::gather(std::span<std::byte> out) const {
  const auto copy = [&](const auto& primitives) {
    using Primitive = typename std::decay_t<decltype(primitives)>::value_type;
    parallelRanges(count, [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k)
        std::memcpy(out.data() + k * sizeof(Primitive), &primitives[map.empty() ? k : map[k]], sizeof(Primitive));
    });
  };
  if (input.kind == GeometryKind::triangles)
    copy(input.triangles);
  else
    copy(input.boxes);
}

BlasData prepareBlas(const BlasInput& input, bool order) {
  if (!order)
    if (std::optional<BlasData> data = asGiven(input)) return *std::move(data);
  Active active = findActive(input);
  BlasData data;
  for (const Bounds3& bounds : active.bounds) data.bounds.extend(bounds);
  std::vector<std::uint32_t> sorted;
  if (order) sorted = spatialOrder(active.bounds, active.counts);
  active.bounds = {};

  std::size_t first = 0;
  for (std::size_t g = 0; g < input.geometries.size(); ++g) {
    const std::size_t count = active.counts[g], inputCount = primitiveCount(input.geometries[g]);
    data.inactiveCount += static_cast<std::uint32_t>(inputCount - count);
    std::vector<std::uint32_t> map = std::move(active.indices[g]);
    if (order) {
      map = orderedMap(map, sorted, first, count);
      if (count == inputCount && isIdentity(map)) map.clear();
    }
    data.geometries.push_back(applyMap(input.geometries[g], std::move(map), count));
    first += count;
  }
  return data;
}

}  // namespace quintet::rt
