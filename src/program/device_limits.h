// What the check needs to know of a device; the default is what every device that Quintet was tested on offers.
#ifndef QUINTET_PROGRAM_DEVICE_LIMITS_H
#define QUINTET_PROGRAM_DEVICE_LIMITS_H

#include <cstdint>
#include <string>

namespace quintet::gpu {
class Context;
}

namespace quintet::program {

struct DeviceLimits {
  std::string name;                         // empty: no device was asked
  std::uint32_t maxRecursion = 31;          // maxRayRecursionDepth
  std::uint32_t maxHitAttributeBytes = 32;  // maxRayHitAttributeSize
  std::uint32_t handleBytes = 32;           // shaderGroupHandleSize
  bool rayTracingQuirks = false;            // lavapipe's defects (docs/design/quirks.md, "Ray tracing")
};

DeviceLimits deviceLimits(const gpu::Context& context);

}  // namespace quintet::program
#endif
