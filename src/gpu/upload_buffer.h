// SPDX-License-Identifier: Apache-2.0
// Buffers that the host fills for each frame.
#ifndef QUINTET_GPU_UPLOAD_BUFFER_H
#define QUINTET_GPU_UPLOAD_BUFFER_H

#include "gpu/buffer.h"

namespace quintet::gpu {

// Replaces the buffer by a mapped one of at least `size` bytes, unless it has them; its content is then lost. `usage`:
// besides transfers. `name`: of the object, for messages. Throws MemoryError.
void reserveUpload(Context& context, Buffer& buffer, VkDeviceSize size, VkBufferUsageFlags usage, const char* name);

}  // namespace quintet::gpu
#endif
