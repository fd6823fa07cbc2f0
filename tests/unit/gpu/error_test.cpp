// SPDX-License-Identifier: Apache-2.0
#include "gpu/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gpu/instance.h"

namespace quintet::gpu {
namespace {

using testing::StrEq;
using testing::Throws;
using testing::ThrowsMessage;

TEST(VulkanError, ContainsOperationObjectAndResult) {
  EXPECT_THAT([] { check(VK_ERROR_FORMAT_NOT_SUPPORTED, "create image", "albedo"); },
              ThrowsMessage<VulkanError>(StrEq("cannot create image 'albedo': VK_ERROR_FORMAT_NOT_SUPPORTED")));
  EXPECT_THAT([] { check(VK_ERROR_INITIALIZATION_FAILED, "create the device"); },
              ThrowsMessage<VulkanError>(StrEq("cannot create the device: VK_ERROR_INITIALIZATION_FAILED")));
}

TEST(VulkanError, HasATypeForEachCause) {
  EXPECT_THAT([] { check(VK_ERROR_OUT_OF_DEVICE_MEMORY, "create buffer", "film"); }, Throws<MemoryError>());
  EXPECT_THAT([] { check(VK_ERROR_OUT_OF_HOST_MEMORY, "create buffer", "film"); }, Throws<MemoryError>());
  EXPECT_THAT([] { check(VK_ERROR_DEVICE_LOST, "wait"); }, Throws<DeviceLostError>());
}

TEST(VulkanError, IgnoresSuccessCodes) {
  for (const VkResult result : {VK_SUCCESS, VK_TIMEOUT, VK_INCOMPLETE, VK_NOT_READY})
    EXPECT_NO_THROW(check(result, "x"));
}

TEST(VulkanError, NamesUnknownResults) {
  EXPECT_EQ(resultName(VK_SUCCESS), "VK_SUCCESS");
  EXPECT_EQ(resultName(static_cast<VkResult>(-123456789)), "an unknown VkResult");
}

TEST(DriverEnvironment, StartsMoreLavapipeThreadsThanCores) {
  EXPECT_EQ(balancingThreads(0), 8u);
  EXPECT_EQ(balancingThreads(1), 8u);
  EXPECT_EQ(balancingThreads(2), 16u);
  EXPECT_EQ(balancingThreads(4), 32u);
  EXPECT_EQ(balancingThreads(64), 32u);
}

TEST(ValidationSink, CountsOnlyMessagesOfValidationLayers) {
  std::vector<std::string> log;
  ValidationSink sink([&](LogLevel, const std::string& line) { log.push_back(line); });
  const VkDebugUtilsMessengerCreateInfoEXT info = sink.messengerInfo();
  VkDebugUtilsMessengerCallbackDataEXT data{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CALLBACK_DATA_EXT};
  data.pMessageIdName = "VUID-some-rule";
  data.pMessage = "two\nlines";
  info.pfnUserCallback(VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT, VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
                       &data, info.pUserData);
  EXPECT_EQ(sink.count(), 1u);
  EXPECT_THAT(sink.messages(), testing::ElementsAre("Vulkan validation: VUID-some-rule: two lines"));
  data.pMessageIdName = nullptr;
  info.pfnUserCallback(VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT, VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT,
                       &data, info.pUserData);
  EXPECT_EQ(sink.count(), 1u) << "messages of the loader are not errors of this program";
  EXPECT_EQ(log.size(), 2u);
}

}  // namespace
}  // namespace quintet::gpu
