// Which of the machine's devices is used: pure functions, tested without a device.
#ifndef QUINTET_GPU_DEVICE_CHOICE_H
#define QUINTET_GPU_DEVICE_CHOICE_H

#include <span>
#include <string>
#include <string_view>

#include "gpu/context.h"

namespace quintet::gpu {

std::string deviceKindName(
    VkPhysicalDeviceType type);               // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
int devicePreference(std::string_view kind);  // smaller is better: discrete, integrated, virtual, other, CPU

// The index of the device that ContextOptions::device = `request` means, in the order of `devices`
// (the order of preference). Throws NoDeviceError with a list of all devices if none fits.
std::size_t chooseDevice(std::span<const DeviceInfo> devices, std::string_view request);

}  // namespace quintet::gpu
#endif
