// Host side of a BLAS build: which primitives take part, and in which order.
#ifndef QUINTET_RT_GEOMETRY_DATA_H
#define QUINTET_RT_GEOMETRY_DATA_H

#include "rt/blas.h"

namespace quintet::rt {

// What the device builds from: the input's arrays and a choice of their primitives.
struct GeometryData {
  GeometryInput input;
  VkGeometryFlagsKHR flags = 0;
  std::vector<std::uint32_t> map;  // built primitive → input primitive; empty: the first `count`
  std::uint32_t count = 0;         // built primitives
  VkDeviceSize primitiveBytes() const;
  // Triangles or boxes in the order of the build; `out` has primitiveBytes().
  void gather(std::span<std::byte> out) const;
};

struct BlasData {
  std::vector<GeometryData> geometries;
  Bounds3 bounds;
  std::uint32_t inactiveCount = 0;
};

// Drops inactive primitives and, if `order`, sorts the rest for a builder that keeps the order.
BlasData prepareBlas(const BlasInput& input, bool order);

// The `count` primitives that `map` lists; an empty map stands for the identity.
GeometryData applyMap(const GeometryInput& input, std::vector<std::uint32_t> map, std::size_t count);

// Box of one primitive; empty: it is inactive.
Bounds3 primitiveBounds(const GeometryInput& input, std::size_t primitive);
std::size_t primitiveCount(const GeometryInput& input);

}  // namespace quintet::rt
#endif
