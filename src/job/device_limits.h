// SPDX-License-Identifier: Apache-2.0
// Limits and driver defects of a device, for the check of a program.
#ifndef QUINTET_JOB_DEVICE_LIMITS_H
#define QUINTET_JOB_DEVICE_LIMITS_H

#include <string>

#include "check/device_limits.h"
#include "gpu/device_info.h"

namespace quintet::job {

check::DeviceLimits deviceLimits(const gpu::DeviceInfo& device);

// The limits of the device that `request` (gpu::ContextOptions::device) selects, without opening it. "none", and an empty
// request on a machine without a usable device, give limits that hold on every tested device. Throws gpu::NoDeviceError.
check::DeviceLimits limitsOfDevice(const std::string& request);

}  // namespace quintet::job
#endif
