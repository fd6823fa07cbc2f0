// Host side of a BLAS build: which primitives take part, and in which order.
#ifndef QUINTET_RT_GEOMETRY_DATA_H
#define QUINTET_RT_GEOMETRY_DATA_H

#include "rt/blas.h"

namespace quintet::rt {

// What the device builds from. Spans point into the input or into the storage below them.
struct GeometryData {
  GeometryKind kind = GeometryKind::triangles;
  VkGeometryFlagsKHR flags = 0;
  std::span<const vec3> positions;
  std::span<const uvec3> triangles;
  std::span<const Bounds3> boxes;
  std::vector<std::uint32_t> map;  // built primitive → input primitive; empty: identity
  std::vector<uvec3> orderedTriangles;
  std::vector<Bounds3> orderedBoxes;
  std::uint32_t count() const {
    return static_cast<std::uint32_t>(kind == GeometryKind::triangles ? triangles.size() : boxes.size());
  }
};

struct BlasData {
  std::vector<GeometryData> geometries;
  Bounds3 bounds;
  std::uint32_t inactiveCount = 0;
};

// Drops inactive primitives and, if `order`, sorts the rest for a builder that keeps the order.
BlasData prepareBlas(const BlasInput& input, bool order);

// The `count` primitives that `map` lists; an empty map stands for the identity.
GeometryData applyMap(const GeometryInput& input, const std::vector<std::uint32_t>& map, std::size_t count);

// Box of one primitive; empty: it is inactive.
Bounds3 primitiveBounds(const GeometryInput& input, std::size_t primitive);
std::size_t primitiveCount(const GeometryInput& input);

}  // namespace quintet::rt
#endif
