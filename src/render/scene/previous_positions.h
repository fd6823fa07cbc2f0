// SPDX-License-Identifier: Apache-2.0
// The positions that deformed vertices had one frame earlier, on the device, for motion vectors.
#ifndef QUINTET_RENDER_SCENE_PREVIOUS_POSITIONS_H
#define QUINTET_RENDER_SCENE_PREVIOUS_POSITIONS_H

#include <cstddef>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "render/scene/geometry_upload.h"

namespace quintet::render {

struct DeformedGeometry {
  std::size_t index = 0;  // in GeometryUpload::geometries
  std::size_t vertexCount = 0;
};

class PreviousPositions {
 public:
  // `geometryCount`: of all geometries. Throws gpu errors.
  PreviousPositions(gpu::Context& context, std::span<const DeformedGeometry> deformed, std::size_t geometryCount);

  // Address[geometryCount]: vec3[] of a deformed geometry, or 0.
  shared::Address table() const { return table_.address(); }
  // Copies the positions that the geometries have now. Blocks; the device must not be tracing.
  void copyFrom(const GeometryUpload& upload);

 private:
  struct Copy {
    std::size_t geometry;
    VkDeviceSize offset, bytes;  // in positions_
  };
  gpu::Context& context_;
  std::vector<Copy> copies_;
  gpu::Buffer positions_, table_;
};

}  // namespace quintet::render
#endif
