// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_query.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace quintet::gpu {
namespace {

Capabilities goodDevice() {
  Capabilities device;
  device.apiVersion = VK_API_VERSION_1_3;
  device.extensions = {VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                       VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME};
  device.computeQueue = true;
  DeviceFeatures& features = device.features;
  features.core.features.shaderInt64 = VK_TRUE;
  features.vulkan12.bufferDeviceAddress = VK_TRUE;
  features.vulkan12.descriptorIndexing = VK_TRUE;
  features.vulkan12.runtimeDescriptorArray = VK_TRUE;
  features.vulkan12.descriptorBindingPartiallyBound = VK_TRUE;
  features.vulkan12.descriptorBindingVariableDescriptorCount = VK_TRUE;
  features.vulkan12.shaderSampledImageArrayNonUniformIndexing = VK_TRUE;
  features.vulkan12.scalarBlockLayout = VK_TRUE;
  features.vulkan12.timelineSemaphore = VK_TRUE;
  features.vulkan13.synchronization2 = VK_TRUE;
  features.vulkan13.maintenance4 = VK_TRUE;
  features.accelerationStructure.accelerationStructure = VK_TRUE;
  features.rayTracingPipeline.rayTracingPipeline = VK_TRUE;
  return device;
}

TEST(DeviceFeatures, AcceptsDevicesWithAllRequiredFeatures) { EXPECT_EQ(unusableReason(goodDevice()), ""); }

TEST(DeviceFeatures, ReportsMissingExtensions) {
  Capabilities device = goodDevice();
  device.extensions.erase(device.extensions.begin());
  EXPECT_EQ(unusableReason(device), "no VK_KHR_ray_tracing_pipeline");
  device.extensions.clear();
  EXPECT_EQ(unusableReason(device),
            "no VK_KHR_ray_tracing_pipeline, no VK_KHR_acceleration_structure, no VK_KHR_deferred_host_operations");
}

TEST(DeviceFeatures, ReportsMissingFeatures) {
  Capabilities device = goodDevice();
  device.features.vulkan12.scalarBlockLayout = VK_FALSE;
  EXPECT_EQ(unusableReason(device), "no feature scalarBlockLayout");
  device = goodDevice();
  device.features.rayTracingPipeline.rayTracingPipeline = VK_FALSE;
  EXPECT_EQ(unusableReason(device), "no feature rayTracingPipeline");
}

TEST(DeviceFeatures, ReportsOldVersionsAndMissingQueues) {
  Capabilities device = goodDevice();
  device.apiVersion = VK_API_VERSION_1_2;
  EXPECT_EQ(unusableReason(device), "Vulkan 1.2 (1.3 is required)");
  device = goodDevice();
  device.computeQueue = false;
  EXPECT_EQ(unusableReason(device), "no compute queue");
}

TEST(DeviceFeatures, EnablesOptionalFeaturesIfSupported) {
  Capabilities device = goodDevice();
  EXPECT_EQ(extensionsToEnable(device).size(), 3u);
  EXPECT_FALSE(featuresToEnable(device).rayTracingMaintenance1.rayTracingMaintenance1);
  device.extensions.emplace_back(VK_KHR_RAY_TRACING_MAINTENANCE_1_EXTENSION_NAME);
  device.features.rayTracingMaintenance1.rayTracingMaintenance1 = VK_TRUE;
  EXPECT_EQ(extensionsToEnable(device).size(), 4u);
  EXPECT_TRUE(featuresToEnable(device).rayTracingMaintenance1.rayTracingMaintenance1);
}

TEST(DeviceFeatures, EnablesNoOtherFeatures) {
  Capabilities device = goodDevice();
  device.features.core.features.shaderFloat64 = VK_TRUE;
  device.features.core.features.robustBufferAccess = VK_TRUE;
  const DeviceFeatures enabled = featuresToEnable(device);
  EXPECT_FALSE(enabled.core.features.shaderFloat64);
  EXPECT_FALSE(enabled.core.features.robustBufferAccess);
  EXPECT_TRUE(enabled.core.features.shaderInt64);
}

TEST(DeviceFeatures, ChainsStructsOfSupportedExtensions) {
  DeviceFeatures features;
  const auto length = [](const VkPhysicalDeviceFeatures2* head) {
    int count = 0;
    for (auto* next = static_cast<const VkBaseInStructure*>(head->pNext); next; next = next->pNext) ++count;
    return count;
  };
  EXPECT_EQ(length(features.chain({})), 2);
  EXPECT_EQ(length(features.chain(goodDevice().extensions)), 4);
  EXPECT_EQ(length(features.chain({})), 2) << "an earlier chain must not remain";
}

}  // namespace
}  // namespace quintet::gpu
