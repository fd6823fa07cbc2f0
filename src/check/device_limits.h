// SPDX-License-Identifier: Apache-2.0
// The properties of a device that the check depends on. The check never opens a device; the renderer fills this in.
#ifndef QUINTET_CHECK_DEVICE_LIMITS_H
#define QUINTET_CHECK_DEVICE_LIMITS_H

#include <cstdint>
#include <string>

namespace quintet::check {

// Driver defects that change the result of a program (docs/design/quirks.md).
struct DriverDefects {
  bool corruptsHitAttributes = false;  // rejected candidates overwrite the attributes of the accepted hit
  bool changesNestedBuiltIns = false;  // built-ins that are read after a nested trace belong to the inner hit
  bool sharesAnyHit = false;  // hit groups with the same intersection stage run the any-hit shader of the first group
  bool sharesLocalArrays = false;  // indexed arrays of an intersection shader and its any-hit shader overlap
};

// The defaults apply to all devices on which Quintet was tested.
struct DeviceLimits {
  std::string name;                         // empty if unknown
  std::uint32_t maxRecursion = 31;          // maxRayRecursionDepth
  std::uint32_t maxHitAttributeBytes = 32;  // maxRayHitAttributeSize
  DriverDefects defects;
};

}  // namespace quintet::check
#endif
