// SPDX-License-Identifier: Apache-2.0
#include "job/device_limits.h"

#include <algorithm>
#include <cstdlib>

#include "gpu/context.h"
#include "gpu/device_list.h"

namespace quintet::job {

check::DeviceLimits deviceLimits(const gpu::DeviceInfo& device) {
  const gpu::Quirks& quirks = device.quirks;
  return {device.name,
          device.limits.maxRecursionDepth,
          device.limits.maxHitAttributeSize,
          {quirks.corruptsHitAttributes, quirks.changesNestedBuiltIns, quirks.sharesAnyHit, quirks.sharesLocalArrays}};
}

check::DeviceLimits limitsOfDevice(const std::string& request) {
  if (request == "none") return {};
  const std::vector<gpu::DeviceInfo> devices = gpu::Context::devices();
  const char* preset = std::getenv("QUINTET_DEVICE");
  const std::string fallback = preset ? preset : "";
  if (request.empty() && fallback.empty() && std::ranges::none_of(devices, &gpu::DeviceInfo::usable)) return {};
  return deviceLimits(devices[gpu::chooseOneDevice(devices, request, fallback)]);
}

}  // namespace quintet::job
