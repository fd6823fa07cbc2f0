// SPDX-License-Identifier: Apache-2.0
// Launches whose size is in device memory: vkCmdTraceRaysIndirectKHR.
#include <iterator>

#include "checks.h"
#include "harness.h"
#include "program.h"

namespace quintet::oracle::launch_test {
namespace {

TEST(Launches, ReadsTheSizeFromMemory) {
  gpu::Context& context = test::testContext();
  VkPhysicalDeviceRayTracingPipelineFeaturesKHR rayTracing{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR};
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  features.pNext = &rayTracing;
  vkGetPhysicalDeviceFeatures2(context.physicalDevice(), &features);
  Checks checks;
  // lavapipe and the H200 both have this feature.
  checks.that(rayTracing.rayTracingPipelineTraceRaysIndirect, "the device has rayTracingPipelineTraceRaysIndirect");
  constexpr uvec3 kSizes[] = {{1, 1, 1}, {7, 5, 3}, {64, 1, 1}, {1, 33, 1}, {1, 1, 9}, {0, 1, 1}, {16, 16, 1}};
  const Program program({.common = "struct Input { uint unused; }; struct Output { uint count; uint size; };\n",
                         .rayGeneration = R"(
void main() {
  atomicAdd(launch.outputs.at[launchIndex()].count, 1u);
  launch.outputs.at[launchIndex()].size = gl_LaunchSizeEXT.x | gl_LaunchSizeEXT.y << 8 | gl_LaunchSizeEXT.z << 16;
}
)",
                         .miss = {},
                         .hit = {}});
  struct Out {
    std::uint32_t count, size;
  };
  const rt::ShaderBindingTable table(context, program.pipeline(), program.contents({}), "indirect");
  const auto rayGeneration = table.region(table.layout().rayGeneration);
  const gpu::Buffer sizes = gpu::makeBufferOf(context, std::vector<uvec3>(std::begin(kSizes), std::end(kSizes)),
                                              VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, "sizes");
  for (std::size_t k = 0; k < std::size(kSizes); ++k) {
    constexpr std::size_t kRoom = 512;
    const gpu::Buffer outputs = gpu::makeBufferOf(context, std::vector<Out>(kRoom), 0, "outputs");
    const LaunchConstants constants{0, outputs.address()};
    const gpu::BindlessSet& set = Program::set();
    const VkDescriptorSet descriptors = set.set();
    const VkStridedDeviceAddressRegionKHR none{};
    const VolkDeviceTable& vk = context.vk();
    context.submitAndWait([&](gpu::Commands& commands) {
      vk.vkCmdBindPipeline(commands.handle(), VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, program.pipeline().handle());
      vk.vkCmdBindDescriptorSets(commands.handle(), VK_PIPELINE_BIND_POINT_RAY_TRACING_KHR, set.pipelineLayout(), 0, 1,
                                 &descriptors, 0, nullptr);
      vk.vkCmdPushConstants(commands.handle(), set.pipelineLayout(), gpu::BindlessSet::stages(), 0, sizeof constants,
                            &constants);
      vk.vkCmdTraceRaysIndirectKHR(commands.handle(), &rayGeneration, &none, &none, &none,
                                   sizes.address() + k * sizeof(uvec3));
    });
    const uvec3 size = kSizes[k];
    const std::uint32_t count = size.x * size.y * size.z;
    const auto results = outputs.downloadAs<Out>(kRoom);
    for (std::uint32_t i = 0; i < kRoom; ++i) {
      checks.equal(results[i].count, i < count ? 1u : 0u, "size {}: invocation {}", textOf(size), i);
      if (i < count)
        checks.equal(results[i].size, size.x | size.y << 8 | size.z << 16, "size {}: gl_LaunchSizeEXT", textOf(size));
    }
  }
  checks.done();
}

}  // namespace
}  // namespace quintet::oracle::launch_test
