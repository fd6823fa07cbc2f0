// SPDX-License-Identifier: Apache-2.0
#include "render/scene/previous_positions.h"

#include "gpu/commands.h"

namespace quintet::render {

PreviousPositions::PreviousPositions(gpu::Context& context, std::span<const DeformedGeometry> deformed,
                                     std::size_t geometryCount)
    : context_(context) {
  VkDeviceSize total = 0;
  for (const DeformedGeometry& geometry : deformed) {
    const VkDeviceSize bytes = geometry.vertexCount * sizeof(vec3);
    if (bytes > 0) copies_.push_back({geometry.index, total, bytes});
    total += bytes;
  }
  positions_ = gpu::Buffer(context, {.size = total, .name = "previous positions"});
  std::vector<shared::Address> addresses(geometryCount, 0);
  for (const Copy& copy : copies_) addresses[copy.geometry] = positions_.address() + copy.offset;
  table_ = gpu::makeBufferOf(context, addresses, 0, "previous positions of geometries");
}

void PreviousPositions::copyFrom(const GeometryUpload& upload) {
  context_.submitAndWait([&](gpu::Commands& commands) {
    for (const Copy& copy : copies_) {
      const ArraySlot& slot = upload.slots[copy.geometry].positions;
      commands.copy(upload.buffers[slot.buffer], positions_, copy.bytes, slot.offset, copy.offset);
    }
    commands.barrier(gpu::Stage::all, gpu::Stage::all);
  });
}

}  // namespace quintet::render
