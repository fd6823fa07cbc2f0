#include "program/device_limits.h"

namespace quintet::program {

DeviceLimits deviceLimits(const gpu::Context& context) {
  const gpu::DeviceInfo& info = context.info();
  return {info.name, info.limits.maxRecursionDepth, info.limits.maxHitAttributeSize, info.limits.handleSize,
          info.quirks};
}

}  // namespace quintet::program
