// A command buffer while it is recorded (Context::submit hands one out) and the barriers in three verbs.
#ifndef QUINTET_GPU_COMMANDS_H
#define QUINTET_GPU_COMMANDS_H

#include <span>

#include "gpu/buffer.h"
#include "gpu/image.h"

namespace quintet::gpu {

// A pipeline stage with the accesses that matter there, for memory barriers (synchronization2).
enum class Stage { host, transfer, compute, rayTracing, accelerationStructureBuild, all };

class Commands {
 public:
  Commands(Context& context, VkCommandBuffer handle) : context_(context), handle_(handle) {}
  Context& context() const { return context_; }
  VkCommandBuffer handle() const { return handle_; }

  // The three verbs. All memory written by `before` becomes visible to `after`.
  void barrier(Stage before, Stage after);
  // Changes an image's layout, keeping its content (`from` undefined: content is dropped).
  void transition(const Image& image, VkImageLayout from, VkImageLayout to);
  // Makes writes of `before` readable by the host once the submission has ended.
  void toHost(Stage before);

  void copy(const Buffer& source, const Buffer& destination, VkDeviceSize size, VkDeviceSize sourceOffset = 0,
            VkDeviceSize destinationOffset = 0);
  void copy(const Buffer& source, const Image& destination, VkDeviceSize sourceOffset = 0);  // TRANSFER_DST layout
  void copy(const Image& source, const Buffer& destination);                                 // TRANSFER_SRC layout
  void fill(const Buffer& destination, std::uint32_t word, VkDeviceSize offset = 0, VkDeviceSize size = VK_WHOLE_SIZE);

 private:
  Context& context_;
  VkCommandBuffer handle_;
};

}  // namespace quintet::gpu
#endif
