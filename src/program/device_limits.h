// What the check needs to know of a device; the default is what every device that Quintet was tested on offers.
#ifndef QUINTET_PROGRAM_DEVICE_LIMITS_H
#define QUINTET_PROGRAM_DEVICE_LIMITS_H

#include <cstdint>
#include <string>

#include "gpu/context.h"

namespace quintet::program {

struct DeviceLimits {
  std::string name;                         // empty: no device was asked
  std::uint32_t maxRecursion = 31;          // maxRayRecursionDepth
  std::uint32_t maxHitAttributeBytes = 32;  // maxRayHitAttributeSize
  std::uint32_t handleBytes = 32;           // shaderGroupHandleSize
  gpu::Quirks quirks;                       // defects of its driver (docs/design/quirks.md); default: none
};

DeviceLimits deviceLimits(const gpu::DeviceInfo& device);

}  // namespace quintet::program
#endif
