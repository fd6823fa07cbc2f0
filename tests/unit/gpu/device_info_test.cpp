// SPDX-License-Identifier: Apache-2.0
#include "gpu/device_info.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "gpu/error.h"

namespace quintet::gpu {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<DeviceInfo> threeDevices() {
  std::vector<DeviceInfo> devices(3);
  devices[0].name = "NVIDIA H200";
  devices[0].driver = "NVIDIA 580.159.04";
  devices[0].driverName = "NVIDIA";
  devices[0].kind = "discrete GPU";
  devices[1].name = "Old Card 7";
  devices[1].driver = "oldie 1.0";
  devices[1].driverName = "oldie";
  devices[1].kind = "discrete GPU";
  devices[1].unusableReason = "no VK_KHR_ray_tracing_pipeline";
  devices[2].name = "llvmpipe (LLVM 15.0.6, 256 bits)";
  devices[2].driver = "lavapipe 25.0.7 (LLVM 15.0.6)";
  devices[2].driverName = "lavapipe";
  devices[2].kind = "CPU";
  for (std::uint32_t i = 0; i < 3; ++i) devices[i].index = i;
  return devices;
}

TEST(DeviceChoice, PrefersGpusToCpus) {
  EXPECT_LT(devicePreference("discrete GPU"), devicePreference("integrated GPU"));
  EXPECT_LT(devicePreference("integrated GPU"), devicePreference("virtual GPU"));
  EXPECT_LT(devicePreference("virtual GPU"), devicePreference("other"));
  EXPECT_LT(devicePreference("other"), devicePreference("CPU"));
}

TEST(DeviceChoice, SelectsTheFirstUsableDeviceByDefault) {
  std::vector<DeviceInfo> devices = threeDevices();
  EXPECT_EQ(chooseDevice(devices, ""), 0u);
  devices[0].unusableReason = "no VK_KHR_acceleration_structure";
  EXPECT_EQ(chooseDevice(devices, ""), 2u);
}

TEST(DeviceChoice, SelectsByIndexNameDriverOrKind) {
  const std::vector<DeviceInfo> devices = threeDevices();
  EXPECT_EQ(chooseDevice(devices, "2"), 2u);
  EXPECT_EQ(chooseDevice(devices, "h200"), 0u);
  EXPECT_EQ(chooseDevice(devices, "LavaPipe"), 2u);
  EXPECT_EQ(chooseDevice(devices, "llvmpipe"), 2u);
  EXPECT_EQ(chooseDevice(devices, "cpu"), 2u);
  EXPECT_EQ(chooseDevice(devices, "gpu"), 0u);
}

TEST(DeviceChoice, UsesANumberAsAnIndexOnly) {
  const std::vector<DeviceInfo> devices = threeDevices();
  for (const char* request : {"3", "7", "15", "20", "200", "580", "99999999999999999999999"})
    EXPECT_THAT(
        [&] { chooseDevice(devices, request); },
        ThrowsMessage<NoDeviceError>(
            AllOf(HasSubstr(std::string("no device with index ") + request + "; found 0: "), HasSubstr("2: llvmpipe"))))
        << "part of a name or of a version";
}

TEST(DeviceChoice, MatchesNoVersionNumbers) {
  const std::vector<DeviceInfo> devices = threeDevices();
  for (const char* request : {"15.0.6", "25.0", "580.159.04", "159.", "llvm 15"})
    EXPECT_THROW(chooseDevice(devices, request), NoDeviceError) << request;
  EXPECT_EQ(chooseDevice(devices, "llvm"), 2u);
}

TEST(DeviceChoice, ListsAllDevicesIfNoneMatches) {
  const std::vector<DeviceInfo> devices = threeDevices();
  EXPECT_THAT([&] { chooseDevice(devices, "radeon"); },
              ThrowsMessage<NoDeviceError>(AllOf(HasSubstr("no device 'radeon'"), HasSubstr("0: NVIDIA H200"),
                                                 HasSubstr("1: Old Card 7"), HasSubstr("2: llvmpipe"))));
  EXPECT_THROW(chooseDevice(devices, "3"), NoDeviceError);
  EXPECT_THROW(chooseDevice(devices, "-1"), NoDeviceError);
}

TEST(DeviceChoice, ReportsWhyARequestedDeviceCannotBeUsed) {
  const std::vector<DeviceInfo> devices = threeDevices();
  for (const char* request : {"1", "old card"})
    EXPECT_THAT([&] { chooseDevice(devices, request); },
                ThrowsMessage<NoDeviceError>(AllOf(HasSubstr("cannot use device"),
                                                   HasSubstr("cannot be used: no VK_KHR_ray_tracing_pipeline"))));
}

TEST(DeviceChoice, ReportsMissingDevices) {
  EXPECT_THAT([] { chooseDevice({}, ""); }, ThrowsMessage<NoDeviceError>(HasSubstr("no Vulkan device found")));
  std::vector<DeviceInfo> devices = threeDevices();
  devices.resize(2);
  devices[0].unusableReason = "Vulkan 1.1 (1.3 is required)";
  EXPECT_THAT(
      [&] { chooseDevice(devices, ""); },
      ThrowsMessage<NoDeviceError>(AllOf(HasSubstr("no usable device"), HasSubstr("Vulkan 1.1 (1.3 is required)"))));
}

}  // namespace
}  // namespace quintet::gpu
