// SPDX-License-Identifier: Apache-2.0
// Properties of a Vulkan device, and the choice of one of the machine's devices.
#ifndef QUINTET_GPU_DEVICE_INFO_H
#define QUINTET_GPU_DEVICE_INFO_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "gpu/vulkan.h"

namespace quintet::gpu {

// Driver defects that other layers work around. docs/design/quirks.md lists drivers, versions, workarounds and the
// tests that fail once a driver is fixed.
struct Quirks {
  bool keepsPrimitiveOrder = false;  // builds a tree over the input order: sort primitives and instances first
  bool slowInstances = false;        // traverses in software: each instance whose box a ray enters takes time
  bool slowTraceCalls = false;       // a trace that calls shaders stores the caller's state in memory: use ray queries
  bool corruptsHitAttributes = false;  // rejected candidates overwrite hit attributes: recompute them in closest-hit
  bool noCompaction = false;           // the compacted size equals the full size
  bool changesNestedBuiltIns = false;  // built-ins that are read after a nested trace belong to the inner hit
  bool sharesAnyHit = false;       // hit groups that share an intersection stage use the first group's any-hit shader
  bool sharesLocalArrays = false;  // indexed arrays of an intersection shader and its any-hit shader overlap
  bool waitsInBuilds = false;      // threads of a build wait actively for each other: no more threads than cores
  unsigned launchParts = 0;        // the driver's threads each take a contiguous part of a launch: interleave its rows
  bool presentingRequiresGlx = false;  // crashes in queries of surfaces of X servers without the extension GLX
};

// 0 without ray tracing.
struct RayTracingLimits {
  std::uint32_t handleSize = 0;       // bytes, shaderGroupHandleSize
  std::uint32_t handleAlignment = 0;  // bytes, shaderGroupHandleAlignment
  std::uint32_t baseAlignment = 0;    // bytes, shaderGroupBaseAlignment
  std::uint32_t maxRecordStride = 0;  // bytes, maxShaderGroupStride
  std::uint32_t maxRecursionDepth = 0;
  std::uint32_t maxHitAttributeSize = 0;   // bytes
  std::uint32_t maxLaunchInvocations = 0;  // width · height · depth
  std::uint32_t scratchAlignment = 0;      // bytes, minAccelerationStructureScratchOffsetAlignment
  std::uint64_t maxGeometries = 0;
  std::uint64_t maxInstances = 0;
  std::uint64_t maxPrimitives = 0;
};

struct DeviceInfo {
  std::uint32_t index = 0;  // in the order of Context::devices()
  std::string name;         // "NVIDIA H200"
  std::string driver;       // name, version and info: "lavapipe 25.0.7 (LLVM 15.0.6)"
  std::string driverName;   // "lavapipe"
  std::string uuid;         // 32 hexadecimal digits
  std::string kind;         // "discrete GPU", "integrated GPU", "CPU", …
  bool software = false;    // the device is the CPU (lavapipe): device memory is host memory
  std::uint32_t apiVersion = 0;
  std::uint64_t memoryBytes = 0;     // of the largest device-local heap
  std::uint64_t maxBufferBytes = 0;  // of one buffer
  std::uint32_t maxImageSize = 0;    // pixels, width and height of a 2D image
  std::uint32_t maxTextures = 0;     // combined image samplers that one shader can access
  std::string unusableReason;        // why Quintet cannot use the device; empty if it can
  RayTracingLimits limits;
  bool rayQuery = false;
  bool positionFetch = false;
  bool shaderClock = false;         // shaders can read a clock (clock2x32ARB)
  bool pipelineStatistics = false;  // rt::pipelineStatistics returns values
  float timestampPeriod = 0.0f;     // nanoseconds per tick; 0 without timestamps
  std::uint32_t timestampBits = 0;  // valid low bits of a timestamp
  std::uint32_t subgroupSize = 0;
  std::array<std::uint8_t, 16> pipelineCacheUuid{};
  Quirks quirks;
  bool usable() const { return unusableReason.empty(); }
};

// Returns "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other".
std::string deviceKindName(VkPhysicalDeviceType type);
// Returns the rank of a kind; smaller is better: discrete, integrated, virtual, other, CPU.
int devicePreference(std::string_view kind);

// Returns the index of the device that ContextOptions::device = `request` selects. `devices` are in the order of
// preference. A request of digits is an index and never a part of a name. Any other request is the complete name, or a part
// of the name without version numbers, of the driver name, or of the kind. Throws NoDeviceError with a list of all
// devices if none matches.
std::size_t chooseDevice(std::span<const DeviceInfo> devices, std::string_view request);

}  // namespace quintet::gpu
#endif
