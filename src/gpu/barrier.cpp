// SPDX-License-Identifier: Apache-2.0
#include "gpu/barrier.h"

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
      // Shader binding tables are read as shader memory; the access bit of ray_tracing_maintenance1 is not needed.
      return {VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, VK_ACCESS_2_SHADER_WRITE_BIT,
              kShaderReads | VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR};
    case Stage::accelerationStructureBuild:
      // SHADER_READ covers vertices, indices, transforms and instances.
      return {VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
              VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
              VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_2_SHADER_READ_BIT};
    case Stage::all: break;
  }
  return {VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT, VK_ACCESS_2_MEMORY_READ_BIT};
}

}  // namespace

void recordBarrier(const VolkDeviceTable& vk, VkCommandBuffer commands, Stage before, Stage after) {
  const StageMasks source = masksOf(before);
  const StageMasks destination = masksOf(after);
  VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  barrier.srcStageMask = source.stages;
  barrier.srcAccessMask = source.writes;
  barrier.dstStageMask = destination.stages;
  barrier.dstAccessMask = destination.reads | destination.writes;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &barrier;
  vk.vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace quintet::gpu
