// SPDX-License-Identifier: Apache-2.0
// Uploads the vertex attributes, triangles and primitive sets of a scene into a few large buffers.
#ifndef QUINTET_RENDER_SCENE_GEOMETRY_UPLOAD_H
#define QUINTET_RENDER_SCENE_GEOMETRY_UPLOAD_H

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/uploader.h"
#include "quintet/shared/frame.h"
#include "scene/model/scene.h"

namespace quintet::render {

// Host view of the arrays that an acceleration structure is built from, in mapped device memory or in the scene.
struct GeometryArrays {
  std::span<const vec3> positions;
  std::span<const uvec3> triangles;
};

// Where an array is in GeometryUpload::buffers.
struct ArraySlot {
  std::size_t buffer = 0;
  VkDeviceSize offset = 0;
  VkDeviceSize bytes = 0;
};

// The arrays of a geometry that an acceleration structure is built from.
struct VertexSlots {
  ArraySlot positions, triangles;
};

// Geometries and primitive sets in the order of hit records. The caller sets the addresses of primitive maps.
struct GeometryUpload {
  std::deque<gpu::Buffer> buffers;
  std::vector<shared::GeometryData> geometries;
  std::vector<GeometryArrays> arrays;        // parallel to `geometries`; empty for primitive sets
  std::vector<VertexSlots> slots;            // parallel to `geometries`; not used for primitive sets
  std::vector<std::uint32_t> firstGeometry;  // per mesh
  std::uint64_t bytes = 0;
};

// Returns the bytes that uploadGeometries() transfers through the uploader. 0 on a CPU, where arrays are written
// directly.
VkDeviceSize geometryUploadBytes(const gpu::Context& context, const scene::Scene& scene);

// An array in host memory: a copy, or a view of mapped device memory.
template <class T>
struct HostArray {
  std::vector<T> copy;
  std::span<const T> mapped;
  std::span<const T> values() const { return copy.empty() ? mapped : std::span<const T>(copy); }
};

// Reads an array from the device. Blocks, unless the memory is mapped.
template <class T>
HostArray<T> readArray(const GeometryUpload& upload, const ArraySlot& slot) {
  const gpu::Buffer& buffer = upload.buffers[slot.buffer];
  HostArray<T> array;
  if (buffer.mapped()) {
    array.mapped = {reinterpret_cast<const T*>(buffer.mapped() + slot.offset), slot.bytes / sizeof(T)};
  } else {
    array.copy.resize(slot.bytes / sizeof(T));
    buffer.download(std::as_writable_bytes(std::span(array.copy)), slot.offset);
  }
  return array;
}

// Uploads all geometries. `consumed`: null, or the scene itself, of which each array is freed that GeometryUpload::arrays
// does not refer to.
GeometryUpload uploadGeometries(gpu::Context& context, gpu::Uploader& uploader, const scene::Scene& scene,
                                scene::Scene* consumed);

}  // namespace quintet::render
#endif
