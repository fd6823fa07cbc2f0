// SPDX-License-Identifier: Apache-2.0
// The choice of several devices: a list such as "0,2", or "all". One device per entry; a device that is named twice is opened
// twice, as two devices.
#ifndef QUINTET_GPU_DEVICE_LIST_H
#define QUINTET_GPU_DEVICE_LIST_H

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gpu/device_info.h"

namespace quintet::gpu {

// Returns whether a request can select more than one device: "all", or entries that commas separate. Commas in parentheses
// are part of a name.
bool isDeviceList(std::string_view request);

// Returns whether both devices render the same bytes: they have the same name and driver.
bool isSameKind(const DeviceInfo& a, const DeviceInfo& b);

// Returns the indices in `devices` that a request selects, in its order. "all" selects all usable devices; without `mixed` only
// those of the same kind as the first usable one. An entry of a list selects one device, as in chooseDevice(). Throws
// NoDeviceError for an entry that selects none, and UsageError for an empty entry, and for different kinds without `mixed`.
std::vector<std::size_t> chooseDevices(std::span<const DeviceInfo> devices, const std::string& request, bool mixed);

// Returns the index of the device that `request` selects where one device is used. Empty means `fallback` (of the environment),
// and of a list there the first entry. Throws as chooseDevices(), and UsageError for a list in `request`.
std::size_t chooseOneDevice(std::span<const DeviceInfo> devices, const std::string& request,
                            const std::string& fallback);

// Returns the request that selects the device with this index.
std::string requestOf(std::size_t device);

}  // namespace quintet::gpu
#endif
