// SPDX-License-Identifier: Apache-2.0
// The store creates each pipeline once and keeps released ones for a while.
#include "gpu/pipeline_store.h"

#include <gtest/gtest.h>

#include "base/hash.h"
#include "gpu/descriptors.h"
#include "gpu/error.h"
#include "harness.h"

namespace quintet::gpu {
namespace {

Context& context() { return test::testContext(); }

// Creates a compute pipeline.
VkPipeline makePipeline() {
  const VolkDeviceTable& vk = context().vk();
  const auto spirv = test::compileCompute("#version 460\nlayout(local_size_x = 64) in; void main() {}");
  VkShaderModuleCreateInfo moduleInfo{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
  moduleInfo.codeSize = 4 * spirv.size();
  moduleInfo.pCode = spirv.data();
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage = {VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.pName = "main";
  info.layout = test::testSet().pipelineLayout();
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vk.vkCreateShaderModule(context().device(), &moduleInfo, nullptr, &info.stage.module), "load", "empty");
  const VkResult result = vk.vkCreateComputePipelines(context().device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
  vk.vkDestroyShaderModule(context().device(), info.stage.module, nullptr);
  check(result, "create", "empty");
  return pipeline;
}

struct Counted {
  PipelineStore store{context().vk(), context().device(),
                      [](std::function<void()> destroy) { context().retire(std::move(destroy)); }};
  int made = 0;
  VkPipeline acquire(std::uint64_t key) {
    return store.acquire(Hash{0, key}, [this] { return ++made, makePipeline(); });
  }
  void release(std::uint64_t key) { store.release(Hash{0, key}); }
};

// The store destroys all pipelines at the end; otherwise the validation layers would report them.
TEST(GpuPipelineStore, CreatesEachPipelineOnce) {
  Counted counted;
  const VkPipeline first = counted.acquire(1);
  EXPECT_EQ(counted.acquire(1), first);
  EXPECT_EQ(counted.made, 1);
  EXPECT_NE(counted.acquire(2), first);
  EXPECT_EQ(counted.made, 2);
  counted.release(1);
  counted.release(1);
  EXPECT_EQ(counted.acquire(1), first) << "released pipelines are kept";
  EXPECT_EQ(counted.made, 2);
}

TEST(GpuPipelineStore, DestroysTheOldestUnusedPipeline) {
  Counted counted;
  constexpr std::uint64_t kMany = PipelineStore::kKept + 2;
  const VkPipeline used = counted.acquire(1000);
  for (std::uint64_t key = 0; key < kMany; ++key) counted.acquire(key), counted.release(key);
  EXPECT_EQ(counted.made, static_cast<int>(kMany) + 1);
  for (std::uint64_t key = 2; key < kMany; ++key) counted.acquire(key), counted.release(key);
  EXPECT_EQ(counted.acquire(1000), used) << "used pipelines are kept";
  EXPECT_EQ(counted.made, static_cast<int>(kMany) + 1) << "other unused pipelines are kept";
  counted.acquire(0);
  EXPECT_EQ(counted.made, static_cast<int>(kMany) + 2);
}

}  // namespace
}  // namespace quintet::gpu
