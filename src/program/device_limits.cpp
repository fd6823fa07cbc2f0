#include "program/device_limits.h"

namespace quintet::program {

DeviceLimits deviceLimits(const gpu::DeviceInfo& device) {
  return {device.name, device.limits.maxRecursionDepth, device.limits.maxHitAttributeSize, device.limits.handleSize,
          device.quirks};
}

}  // namespace quintet::program
