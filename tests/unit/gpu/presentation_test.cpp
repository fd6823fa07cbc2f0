// SPDX-License-Identifier: Apache-2.0
#include "gpu/present/presentation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace quintet::gpu {
namespace {

using testing::HasSubstr;

TEST(Presentation, StatesWhyADeviceCannotPresent) {
  Capabilities device;
  device.apiVersion = VK_API_VERSION_1_3;
  device.extensions = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
  EXPECT_EQ(cannotPresentReason(device, true), "");
  EXPECT_THAT(cannotPresentReason(device, false), HasSubstr("queue"));
  EXPECT_THAT(cannotPresentReason(device, false, true), HasSubstr("GLX"));
  device.extensions.clear();
  EXPECT_EQ(cannotPresentReason(device, true), "no VK_KHR_swapchain");
  device.apiVersion = VK_API_VERSION_1_2;
  EXPECT_THAT(cannotPresentReason(device, true), HasSubstr("Vulkan 1.2 (1.3 is required), no VK_KHR_swapchain"));
}

}  // namespace
}  // namespace quintet::gpu
