#include "program/device_limits.h"

#include "gpu/context.h"

namespace quintet::program {

DeviceLimits deviceLimits(const gpu::Context& context) {
  const gpu::DeviceInfo& info = context.info();
  return {info.name, info.limits.maxRecursionDepth, info.limits.maxHitAttributeSize, info.limits.handleSize,
          info.quirks.software};
}

}  // namespace quintet::program
