// SPDX-License-Identifier: Apache-2.0
#include "gpu/context.h"

#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gpu/buffer.h"
#include "gpu/commands.h"
#include "gpu/driver_environment.h"
#include "gpu/error.h"
#include "harness.h"

namespace quintet::gpu {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::ThrowsMessage;

TEST(GpuContext, ListsDevicesInOrderOfPreference) {
  const std::vector<DeviceInfo> devices = Context::devices();
  ASSERT_THAT(devices, Not(IsEmpty()));
  for (std::uint32_t i = 0; i < devices.size(); ++i) {
    EXPECT_EQ(devices[i].index, i);
    EXPECT_THAT(devices[i].name, Not(IsEmpty()));
    EXPECT_THAT(devices[i].driver, Not(IsEmpty()));
    EXPECT_EQ(devices[i].uuid.size(), 32u);
    EXPECT_GT(devices[i].memoryBytes, 0u);
    if (i == 0) continue;
    EXPECT_TRUE(devices[i].kind != "discrete GPU" || devices[i - 1].kind == "discrete GPU");
  }
}

TEST(GpuContext, DescribesItsDevice) {
  const DeviceInfo& info = test::testContext().info();
  EXPECT_TRUE(info.usable()) << info.unusableReason;
  EXPECT_GE(info.apiVersion, VK_API_VERSION_1_3);
  // Minimum limits of Vulkan for ray tracing devices.
  EXPECT_EQ(info.limits.handleSize, 32u);
  EXPECT_GE(info.limits.maxRecursionDepth, 1u);
  EXPECT_GE(info.limits.maxHitAttributeSize, 32u);
  EXPECT_GE(info.limits.maxRecordStride, 4096u);
  EXPECT_GE(info.limits.maxLaunchInvocations, 1u << 30 >> 10);
  EXPECT_LE(info.limits.scratchAlignment, 256u);
  EXPECT_GE(info.limits.maxPrimitives, (std::uint64_t{1} << 24) - 1);
  EXPECT_GE(info.limits.maxInstances, (std::uint64_t{1} << 24) - 1);
  EXPECT_GT(info.timestampPeriod, 0.0f);
  EXPECT_GE(info.maxTextures, 16u);
  EXPECT_GE(info.maxImageSize, 4096u);
  EXPECT_GE(info.maxBufferBytes, std::uint64_t{1} << 30);
  EXPECT_EQ(info.software, info.driver.starts_with("lavapipe"));
}

TEST(GpuContext, SelectsADeviceByIndexAndName) {
  const DeviceInfo& info = test::testContext().info();
  EXPECT_EQ(Context({.device = std::to_string(info.index)}).info().uuid, info.uuid);
  EXPECT_EQ(Context({.device = info.name}).info().name, info.name);
}

TEST(GpuContext, ListsTheDevicesIfNoneMatches) {
  EXPECT_THAT(
      [] { const Context context({.device = "voodoo"}); },
      ThrowsMessage<NoDeviceError>(AllOf(HasSubstr("no device 'voodoo'"), HasSubstr(test::testContext().info().name))));
}

TEST(GpuContext, CanExistTwice) {
  Context& first = test::testContext();
  Context second({.device = first.info().name});
  const std::vector<int> numbers = {1, 2, 3};
  const Buffer one = makeBufferOf(first, numbers, 0, "one");
  const Buffer two = makeBufferOf(second, numbers, 0, "two");
  EXPECT_EQ(one.downloadAs<int>(3), numbers);
  EXPECT_EQ(two.downloadAs<int>(3), numbers);
}

TEST(GpuContext, SetsLavapipeVariablesUnlessDisabled) {
  if (!test::testContext().info().software || std::getenv("QUINTET_NO_DRIVER_WORKAROUNDS")) return;
  EXPECT_TRUE(std::getenv("LP_NUM_THREADS"));
  // "lavapipe 25.0.7 (LLVM 15.0.6)": versions before 19 are not correct for AVX-512.
  const std::string& driver = test::testContext().info().driver;
  const std::size_t llvm = driver.find("LLVM ");
  ASSERT_NE(llvm, std::string::npos) << driver;
  const bool wrong = cpuHasAvx512() && std::atoi(driver.c_str() + llvm + 5) < 19;
  EXPECT_EQ(std::getenv("GALLIUM_OVERRIDE_CPU_CAPS") != nullptr, wrong) << driver;
}

// A separate Context, so that the shared one has no validation messages.
class GpuValidation : public testing::Test {
 protected:
  Context context{{.device = test::testContext().info().name, .validate = true}};
};

TEST_F(GpuValidation, ReportsNothingForCorrectUse) {
  const Buffer buffer = makeBufferOf(context, std::vector<int>(1000, 7), 0, "sevens");
  EXPECT_EQ(buffer.downloadAs<int>(1000), std::vector<int>(1000, 7));
  EXPECT_EQ(context.validationMessageCount(), 0u);
}

TEST_F(GpuValidation, CountsMessages) {
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = 16;  // without usage
  VkBuffer buffer = VK_NULL_HANDLE;
  ASSERT_EQ(context.vk().vkCreateBuffer(context.device(), &info, nullptr, &buffer), VK_SUCCESS);
  context.vk().vkDestroyBuffer(context.device(), buffer, nullptr);
  EXPECT_GE(context.validationMessageCount(), 1u);
  ASSERT_FALSE(context.validationMessages().empty());
  EXPECT_THAT(context.validationMessages()[0], HasSubstr("VUID-VkBufferCreateInfo-usage"));
}

TEST_F(GpuValidation, FindsMissingBarriers) {
  const Buffer source = makeBufferOf(context, std::vector<int>(16, 1), 0, "source");
  const Buffer middle(context, {.size = 64, .name = "middle"});
  const Buffer target(context, {.size = 64, .name = "target"});
  context.submitAndWait([&](Commands& commands) {
    commands.copy(source, middle, 64);
    commands.copy(middle, target, 64);
  });
  ASSERT_EQ(context.validationMessageCount(), 1u);
  EXPECT_THAT(context.validationMessages()[0], HasSubstr("SYNC-HAZARD-READ-AFTER-WRITE"));
}

TEST_F(GpuValidation, AcceptsTheBarrier) {
  const Buffer source = makeBufferOf(context, std::vector<int>(16, 1), 0, "source");
  const Buffer middle(context, {.size = 64, .name = "middle"});
  const Buffer target(context, {.size = 64, .name = "target"});
  context.submitAndWait([&](Commands& commands) {
    commands.copy(source, middle, 64);
    commands.barrier(Stage::transfer, Stage::transfer);
    commands.copy(middle, target, 64);
  });
  EXPECT_EQ(target.downloadAs<int>(16), std::vector<int>(16, 1));
  EXPECT_EQ(context.validationMessageCount(), 0u);
}

TEST_F(GpuValidation, NamesObjects) {
  const Buffer buffer(context, {.size = 64, .name = "a buffer with a name"});
  const Buffer target(context, {.size = 64, .name = "target"});
  context.submitAndWait([&](Commands& commands) {
    commands.fill(buffer, 1);
    commands.copy(buffer, target, 64);
  });
  ASSERT_FALSE(context.validationMessages().empty());
  EXPECT_THAT(context.validationMessages()[0], HasSubstr("a buffer with a name"));
}

}  // namespace
}  // namespace quintet::gpu
