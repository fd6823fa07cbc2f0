// SPDX-License-Identifier: Apache-2.0
// A command buffer during recording (see Context::submit): barriers, layout transitions and copies.
#ifndef QUINTET_GPU_COMMANDS_H
#define QUINTET_GPU_COMMANDS_H

#include <cstdint>

#include "gpu/barrier.h"
#include "gpu/buffer.h"
#include "gpu/context.h"
#include "gpu/image.h"

namespace quintet::gpu {

class Commands {
 public:
  Commands(Context& context, VkCommandBuffer handle) : context_(context), handle_(handle) {}
  Context& context() const { return context_; }
  VkCommandBuffer handle() const { return handle_; }

  // Makes all memory that `before` wrote visible to `after`.
  void barrier(Stage before, Stage after) { recordBarrier(context_.vk(), handle_, before, after); }
  // Makes writes of `before` readable by the host after the end of the submission.
  void toHost(Stage before) { barrier(before, Stage::host); }
  // Changes the layout of an image. The content is kept unless `from` is VK_IMAGE_LAYOUT_UNDEFINED.
  void transition(const Image& image, VkImageLayout from, VkImageLayout to) { transition(image.handle(), from, to); }
  void transition(VkImage image, VkImageLayout from, VkImageLayout to);  // of a color image with one level and layer

  void copy(const Buffer& source, const Buffer& destination, VkDeviceSize size, VkDeviceSize sourceOffset = 0,
            VkDeviceSize destinationOffset = 0);
  // The image must have the layout TRANSFER_DST_OPTIMAL or TRANSFER_SRC_OPTIMAL.
  void copy(const Buffer& source, const Image& destination, VkDeviceSize sourceOffset = 0);
  void copy(const Image& source, const Buffer& destination);
  void fill(const Buffer& destination, std::uint32_t word, VkDeviceSize offset = 0, VkDeviceSize size = VK_WHOLE_SIZE);

 private:
  Context& context_;
  VkCommandBuffer handle_;
};

}  // namespace quintet::gpu
#endif
