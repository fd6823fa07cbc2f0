#include "rt/buffer_filler.h"

#include <algorithm>
#include <cassert>

namespace quintet::rt {

BufferFiller::BufferFiller(gpu::Context& context, VkDeviceSize expectedBytes)
    : context_(context), stagingBytes_(std::clamp<VkDeviceSize>(2 * expectedBytes, 1 << 16, VkDeviceSize{64} << 20)) {}

gpu::Buffer BufferFiller::make(VkDeviceSize size, VkBufferUsageFlags usage, const std::string& name,
                               gpu::Purpose purpose) const {
  const gpu::Memory memory = context_.info().quirks.software ? gpu::Memory::upload : gpu::Memory::device;
  return gpu::Buffer(context_, {.size = size, .memory = memory, .usage = usage, .name = name, .purpose = purpose});
}

void BufferFiller::write(const gpu::Buffer& buffer, VkDeviceSize offset, std::span<const std::byte> data) {
  if (data.empty()) return;
  assert(offset + data.size() <= buffer.size());
  if (buffer.mapped()) {
    std::memcpy(buffer.mapped() + offset, data.data(), data.size());
    return;
  }
  if (!uploader_) uploader_.emplace(context_, stagingBytes_);
  uploader_->upload(buffer, data, offset);
}

void BufferFiller::flush() {
  if (uploader_) uploader_->flush();
}

}  // namespace quintet::rt
