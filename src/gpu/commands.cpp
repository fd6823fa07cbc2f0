#include "gpu/commands.h"

#include <cassert>

namespace quintet::gpu {

namespace {

struct StageMasks {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 writes;
  VkAccessFlags2 reads;
};

StageMasks masksOf(Stage stage) {
  constexpr VkAccessFlags2 kShaderReads = VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT;
  switch (stage) {
    case Stage::host: return {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_WRITE_BIT, VK_ACCESS_2_HOST_READ_BIT};
    case Stage::transfer:
      return {VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_ACCESS_2_TRANSFER_READ_BIT};
    case Stage::compute: return {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT, kShaderReads};
    case Stage::rayTracing:
      // Shader binding tables are read as shader memory (without ray_tracing_maintenance1's own bit).
      return {VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, VK_ACCESS_2_SHADER_WRITE_BIT,
              kShaderReads | VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR};
    case Stage::accelerationStructureBuild:
      // SHADER_READ: vertices, indices, transforms and instances.
      return {VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
              VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
              VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_2_SHADER_READ_BIT};
    case Stage::all: break;
  }
  return {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT, VK_ACCESS_2_MEMORY_READ_BIT};
}

void memoryBarrier(Context& context, VkCommandBuffer commands, const VkMemoryBarrier2& barrier) {
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &barrier;
  context.vk().vkCmdPipelineBarrier2(commands, &info);
}

// All of a colour image with one mip level.
constexpr VkImageSubresourceLayers kColorLayer{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};

VkBufferImageCopy wholeImage(const Image& image, VkDeviceSize bufferOffset) {
  VkBufferImageCopy region{};
  region.bufferOffset = bufferOffset;
  region.imageSubresource = kColorLayer;
  region.imageExtent = {image.width(), image.height(), 1};
  return region;
}

}  // namespace

void Commands::barrier(Stage before, Stage after) {
  const StageMasks source = masksOf(before);
  const StageMasks destination = masksOf(after);
  VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  barrier.srcStageMask = source.stages;
  barrier.srcAccessMask = source.writes;
  barrier.dstStageMask = destination.stages;
  barrier.dstAccessMask = destination.reads | destination.writes;
  memoryBarrier(context_, handle_, barrier);
}

void Commands::toHost(Stage before) { barrier(before, Stage::host); }

void Commands::transition(const Image& image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.handle();
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
