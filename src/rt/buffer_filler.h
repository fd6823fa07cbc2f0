// Puts host data where the device reads it: into mapped memory on a CPU device, through a staging
// ring elsewhere.
#ifndef QUINTET_RT_BUFFER_FILLER_H
#define QUINTET_RT_BUFFER_FILLER_H

#include <optional>

#include "gpu/buffer.h"

namespace quintet::rt {

class BufferFiller {
 public:
  // `expectedBytes`: about how much will be written, for the size of the staging ring.
  BufferFiller(gpu::Context& context, VkDeviceSize expectedBytes);
  gpu::Buffer make(VkDeviceSize size, VkBufferUsageFlags usage, const std::string& name, gpu::Purpose purpose) const;
  void write(const gpu::Buffer& buffer, VkDeviceSize offset, std::span<const std::byte> data);
  void flush();  // blocks until the device has everything

 private:
  gpu::Context& context_;
  VkDeviceSize stagingBytes_;
  std::optional<gpu::Uploader> uploader_;
};

}  // namespace quintet::rt
#endif
