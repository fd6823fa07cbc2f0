// SPDX-License-Identifier: Apache-2.0
#include "gpu/commands.h"

#include <cassert>

namespace quintet::gpu {
namespace {

// A color image with one mip level.
constexpr VkImageSubresourceLayers kColorLayer{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};

VkBufferImageCopy wholeImage(const Image& image, VkDeviceSize bufferOffset) {
  VkBufferImageCopy region{};
  region.bufferOffset = bufferOffset;
  region.imageSubresource = kColorLayer;
  region.imageExtent = {image.width(), image.height(), 1};
  return region;
}

}  // namespace

// Defined here and not in context.cpp: the Context does not depend on Commands.
std::uint64_t Context::submit(const std::function<void(Commands&)>& record, const FrameSemaphores& semaphores) {
  return submitRaw(
      [&](VkCommandBuffer handle) {
        Commands commands(*this, handle);
        record(commands);
      },
      semaphores);
}

void Commands::transition(VkImage image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  context_.vk().vkCmdPipelineBarrier2(handle_, &info);
}

void Commands::copy(const Buffer& source, const Buffer& destination, VkDeviceSize size, VkDeviceSize sourceOffset,
                    VkDeviceSize destinationOffset) {
  assert(sourceOffset + size <= source.size() && destinationOffset + size <= destination.size());
  if (size == 0) return;
  const VkBufferCopy region{sourceOffset, destinationOffset, size};
  context_.vk().vkCmdCopyBuffer(handle_, source.handle(), destination.handle(), 1, &region);
}

void Commands::copy(const Buffer& source, const Image& destination, VkDeviceSize sourceOffset) {
  assert(sourceOffset + destination.byteSize() <= source.size());
  const VkBufferImageCopy region = wholeImage(destination, sourceOffset);
  context_.vk().vkCmdCopyBufferToImage(handle_, source.handle(), destination.handle(),
                                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
}

void Commands::copy(const Image& source, const Buffer& destination) {
  assert(source.byteSize() <= destination.size());
  const VkBufferImageCopy region = wholeImage(source, 0);
  context_.vk().vkCmdCopyImageToBuffer(handle_, source.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                       destination.handle(), 1, &region);
}

void Commands::fill(const Buffer& destination, std::uint32_t word, VkDeviceSize offset, VkDeviceSize size) {
  context_.vk().vkCmdFillBuffer(handle_, destination.handle(), offset, size, word);
}

}  // namespace quintet::gpu
