// SPDX-License-Identifier: Apache-2.0
#include "gpu/upload_buffer.h"

namespace quintet::gpu {

void reserveUpload(Context& context, Buffer& buffer, VkDeviceSize size, VkBufferUsageFlags usage, const char* name) {
  if (buffer && buffer.size() >= size) return;
  buffer = Buffer(
      context,
      {.size = size + size / 2, .memory = Memory::upload, .usage = usage, .name = name, .purpose = Purpose::staging});
}

}  // namespace quintet::gpu
