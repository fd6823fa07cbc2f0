// SPDX-License-Identifier: Apache-2.0
#include "gpu/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace quintet::gpu
