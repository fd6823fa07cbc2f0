// SPDX-License-Identifier: Apache-2.0
// Lists of devices: which ones they select, and one clear error for each kind of mistake.
#include "gpu/device_list.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "gpu/error.h"

namespace quintet::gpu {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Two H200, an unusable card, an L40 and the CPU.
std::vector<DeviceInfo> machine() {
  std::vector<DeviceInfo> devices(5);
  for (std::size_t i = 0; i < 4; ++i) {
    devices[i].name = i == 3 ? "NVIDIA L40" : "NVIDIA H200";
    devices[i].driver = "NVIDIA 580";
    devices[i].driverName = "NVIDIA";
    devices[i].kind = "discrete GPU";
  }
  devices[2].name = "Old Card";
  devices[2].unusableReason = "no VK_KHR_ray_tracing_pipeline";
  devices[4].name = "llvmpipe (LLVM 15.0.6, 256 bits)";
  devices[4].driver = "lavapipe 25.0.7";
  devices[4].driverName = "lavapipe";
  devices[4].kind = "CPU";
  for (std::uint32_t i = 0; i < 5; ++i) devices[i].index = i;
  return devices;
}

TEST(DeviceList, IsRecognized) {
  for (const char* list : {"all", "ALL", "0,1", "0,", ",", "h200,cpu"}) EXPECT_TRUE(isDeviceList(list)) << list;
  for (const char* one : {"", "0", "h200", "llvmpipe (LLVM 15.0.6, 256 bits)"}) EXPECT_FALSE(isDeviceList(one)) << one;
}

TEST(DeviceList, SelectsInItsOrderAndRepeats) {
  EXPECT_THAT(chooseDevices(machine(), "1,0", false), ElementsAre(1u, 0u));
  EXPECT_THAT(chooseDevices(machine(), "0,0,0", false), ElementsAre(0u, 0u, 0u));
  EXPECT_THAT(chooseDevices(machine(), "lavapipe,llvmpipe (LLVM 15.0.6, 256 bits)", false), ElementsAre(4u, 4u));
  EXPECT_THAT(chooseDevices(machine(), "cpu", false), ElementsAre(4u));
  EXPECT_THAT(chooseDevices(machine(), "", false), ElementsAre(0u));
}

TEST(DeviceList, AllMeansTheUsableOnesOfTheFirstKind) {
  EXPECT_THAT(chooseDevices(machine(), "all", false), ElementsAre(0u, 1u));
  EXPECT_THAT(chooseDevices(machine(), "all", true), ElementsAre(0u, 1u, 3u, 4u));
  std::vector<DeviceInfo> none = machine();
  for (DeviceInfo& device : none) device.unusableReason = "Vulkan 1.2";
  EXPECT_THROW(chooseDevices(none, "all", false), NoDeviceError);
}

TEST(DeviceList, RejectsDifferentKindsUnlessAllowed) {
  EXPECT_THAT([] { chooseDevices(machine(), "0,3", false); },
              ThrowsMessage<UsageError>(AllOf(HasSubstr("device list '0,3': NVIDIA H200"), HasSubstr("NVIDIA L40"),
                                              HasSubstr("allow mixed devices"))));
  EXPECT_THAT(chooseDevices(machine(), "0,3,4", true), ElementsAre(0u, 3u, 4u));
  std::vector<DeviceInfo> updated = machine();
  updated[1].driver = "NVIDIA 590";
  EXPECT_THROW(chooseDevices(updated, "0,1", false), UsageError) << "another driver is another kind";
}

TEST(DeviceList, NamesTheEntryThatSelectsNothing) {
  EXPECT_THAT([] { chooseDevices(machine(), "0,7", false); },
              ThrowsMessage<NoDeviceError>(
                  AllOf(HasSubstr("device list '0,7': no device with index 7"), HasSubstr("found 0: NVIDIA H200"))));
  EXPECT_THAT([] { chooseDevices(machine(), "0,radeon", false); },
              ThrowsMessage<NoDeviceError>(HasSubstr("no device 'radeon'")));
  EXPECT_THAT([] { chooseDevices(machine(), "0,2", false); },
              ThrowsMessage<NoDeviceError>(HasSubstr("cannot use device 2")));
  EXPECT_THAT([] { chooseDevices(machine(), "0,,1", false); },
              ThrowsMessage<UsageError>(HasSubstr("device list '0,,1': entry 2 is empty")));
  EXPECT_THROW(chooseDevices(machine(), "0,", false), UsageError);
}

TEST(DeviceList, IsNotForOneDevice) {
  EXPECT_EQ(chooseOneDevice(machine(), "3", "0,1"), 3u);
  EXPECT_EQ(chooseOneDevice(machine(), "", ""), 0u);
  EXPECT_EQ(chooseOneDevice(machine(), "", "1,0"), 1u) << "the first entry of the environment";
  EXPECT_EQ(chooseOneDevice(machine(), "llvmpipe (LLVM 15.0.6, 256 bits)", ""), 4u);
  EXPECT_THAT([] { chooseOneDevice(machine(), "0,1", ""); },
              ThrowsMessage<UsageError>(HasSubstr("device '0,1': one device is used here")));
  EXPECT_THROW(chooseOneDevice(machine(), "all", ""), UsageError);
}

}  // namespace
}  // namespace quintet::gpu
