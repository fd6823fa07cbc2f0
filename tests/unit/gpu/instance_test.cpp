// SPDX-License-Identifier: Apache-2.0
// The messages of the validation layers.
#include "gpu/instance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace quintet::gpu {
namespace {

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
