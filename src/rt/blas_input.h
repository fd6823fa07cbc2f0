// SPDX-License-Identifier: Apache-2.0
// Host side of a BLAS build: the input, and which primitives are built in which order. Primitives are sorted spatially
// for drivers that keep the input order (docs/design/quirks.md).
#ifndef QUINTET_RT_BLAS_INPUT_H
#define QUINTET_RT_BLAS_INPUT_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/math.h"
#include "gpu/vulkan.h"

namespace quintet::rt {

enum class GeometryKind { triangles, boxes };

// Host data of one geometry. The arrays must exist until the build call returns.
struct GeometryInput {
  GeometryKind kind = GeometryKind::triangles;
  std::span<const vec3> positions;   // of triangles, object space
  std::span<const uvec3> triangles;  // vertex indices, all in range
  std::span<const Bounds3> boxes;    // of boxes, object space
  bool opaque = true;                // any-hit shaders are not called
  bool singleAnyHit = false;         // NO_DUPLICATE_ANY_HIT_INVOCATION
  // Addresses of the same arrays if they are already on the device, in buffers with the usage
  // ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY. With 0 the array is uploaded for the build.
  VkDeviceAddress positionsAddress = 0;
  VkDeviceAddress trianglesAddress = 0;
};

struct BlasOptions {
  bool fastTrace = true;
  bool allowUpdate = false;     // enables refits
  bool compact = true;          // ignored if the driver gains nothing, and with allowUpdate
  bool keepInputOrder = false;  // for benchmarks: never sorts primitives
  std::string name;
};

struct BlasInput {
  // All of the same kind, because Vulkan does not mix triangles and boxes in a BLAS. Without primitives the BLAS is
  // never hit. Geometries can share one span of positions, which is uploaded once.
  std::vector<GeometryInput> geometries;
  BlasOptions options;
};

// One geometry as it is built: arrays of the input and a selection of its primitives.
struct GeometryData {
  GeometryInput input;
  VkGeometryFlagsKHR flags = 0;
  std::vector<std::uint32_t> map;  // built primitive → input primitive; empty means the first `count` primitives
  std::uint32_t count = 0;         // built primitives
  VkDeviceSize primitiveBytes() const;
  // Writes the triangles or boxes in build order; `out` has primitiveBytes() bytes.
  void gather(std::span<std::byte> out) const;
};

struct BlasData {
  std::vector<GeometryData> geometries;
  Bounds3 bounds;
  std::uint32_t inactiveCount = 0;
};

// Removes inactive primitives (with non-finite vertices or boxes, or a box with min > max). Sorts the others spatially
// if `order` is set.
BlasData prepareBlas(const BlasInput& input, bool order);

// Selects the `count` primitives that `map` lists; an empty map is the identity.
GeometryData applyMap(const GeometryInput& input, std::vector<std::uint32_t> map, std::size_t count);

// Returns the bounds of one primitive; empty if it is inactive.
Bounds3 primitiveBounds(const GeometryInput& input, std::size_t primitive);
std::size_t primitiveCount(const GeometryInput& input);

}  // namespace quintet::rt
#endif
