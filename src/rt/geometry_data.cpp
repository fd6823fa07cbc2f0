#include "rt/geometry_data.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"
#include "rt/spatial_order.h"

namespace quintet::rt {
namespace {

constexpr std::size_t kChunk = 32768;  // primitives per parallel step

std::vector<Bounds3> boundsOf(const GeometryInput& input) {
  std::vector<Bounds3> bounds(primitiveCount(input));
  parallelFor((bounds.size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(bounds.size(), (chunk + 1) * kChunk);
    for (std::size_t k = chunk * kChunk; k < end; ++k) bounds[k] = primitiveBounds(input, k);
  });
  return bounds;
}

// Removes empty bounds; returns the indices of those that stay, or nothing if all do.
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

// The active primitives of all geometries, one after the other.
struct Active {
  std::vector<Bounds3> bounds;
  std::vector<std::size_t> counts;                  // per geometry
  std::vector<std::vector<std::uint32_t>> indices;  // per geometry; empty: all
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

GeometryData applyMap(const GeometryInput& input, const std::vector<std::uint32_t>& map, std::size_t count) {
  GeometryData data;
  data.kind = input.kind;
  if (input.opaque) data.flags |= VK_GEOMETRY_OPAQUE_BIT_KHR;
  if (input.singleAnyHit) data.flags |= VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR;
  data.positions = input.positions;
  data.map = map;
  if (map.empty()) {
    if (input.kind == GeometryKind::triangles) data.triangles = input.triangles.first(count);
    if (input.kind == GeometryKind::boxes) data.boxes = input.boxes.first(count);
    return data;
  }
  if (input.kind == GeometryKind::triangles) {
    data.orderedTriangles.reserve(map.size());
    for (const std::uint32_t k : map) data.orderedTriangles.push_back(input.triangles[k]);
    data.triangles = data.orderedTriangles;
  } else {
    data.orderedBoxes.reserve(map.size());
    for (const std::uint32_t k : map) data.orderedBoxes.push_back(input.boxes[k]);
    data.boxes = data.orderedBoxes;
  }
  return data;
}

BlasData prepareBlas(const BlasInput& input, bool order) {
  Active active = findActive(input);
  BlasData data;
  for (const Bounds3& bounds : active.bounds) data.bounds.extend(bounds);
  std::vector<std::uint32_t> sorted;
  if (order) sorted = spatialOrder(active.bounds, active.counts);

  std::size_t first = 0;
  for (std::size_t g = 0; g < input.geometries.size(); ++g) {
    const std::size_t count = active.counts[g], inputCount = primitiveCount(input.geometries[g]);
    data.inactiveCount += static_cast<std::uint32_t>(inputCount - count);
    std::vector<std::uint32_t> map = std::move(active.indices[g]);
    if (order) {
      std::vector<std::uint32_t> ordered(count);
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t position = sorted[first + k] - first;
        ordered[k] = map.empty() ? static_cast<std::uint32_t>(position) : map[position];
      }
      map = std::move(ordered);
      if (count == inputCount && isIdentity(map)) map.clear();
    }
    data.geometries.push_back(applyMap(input.geometries[g], map, count));
    first += count;
  }
  return data;
}

}  // namespace quintet::rt
