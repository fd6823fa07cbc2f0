// The Vulkan instance, device, queue and allocator: what every other GPU object needs. Move-only
// through its users' references: create one Context, keep it alive longest, pass it explicitly.
#ifndef QUINTET_GPU_CONTEXT_H
#define QUINTET_GPU_CONTEXT_H

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/log.h"
#include "gpu/memory_account.h"
#include "gpu/vulkan.h"

VK_DEFINE_HANDLE(VmaAllocator)

namespace quintet::gpu {

class Commands;
class PipelineStore;

// Defects and habits of a driver that other layers work around (docs/design/quirks.md). Each has a
// test that tells when the driver has mended it.
struct Quirks {
  bool software = false;               // lavapipe: the CPU is the device
  bool keepsPrimitiveOrder = false;    // builder halves the input order: sort primitives and instances first
  bool corruptsHitAttributes = false;  // rejected candidates overwrite them: recompute in closest-hit
  bool noCompaction = false;           // compacted size equals the full size
  bool changesNestedBuiltIns = false;  // built-ins of a hit read after a nested trace are those of the inner hit
  bool sharesAnyHit = false;       // hit groups that share an intersection stage run the first group's any-hit shader
  bool sharesLocalArrays = false;  // indexed arrays of an intersection shader and its any-hit shader overlap
};

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
  std::string driver;       // "lavapipe 25.0.7 (LLVM 15.0.6)": name, version and info
  std::string uuid;         // 32 hex digits
  std::string kind;         // "discrete GPU", "integrated GPU", "CPU", …
  std::uint32_t apiVersion = 0;
  std::uint64_t memoryBytes = 0;     // largest device-local heap
  std::uint64_t maxBufferBytes = 0;  // of one buffer
  std::uint32_t maxImageSize = 0;    // pixels, width and height of a 2D image
  std::uint32_t maxTextures = 0;     // combined image samplers that one shader may see
  std::string refusal;               // why Quintet cannot use it; empty: usable
  RayTracingLimits limits;           // zero when ray tracing is absent
  bool rayQuery = false;
  bool positionFetch = false;
  bool pipelineStatistics = false;  // rt::pipelineStatistics has something to tell
  float timestampPeriod = 0.0f;     // nanoseconds per tick; 0: no timestamps
  std::uint32_t timestampBits = 0;  // valid low bits of a timestamp
  std::uint32_t subgroupSize = 0;
  std::array<std::uint8_t, 16> pipelineCacheUuid{};
  Quirks quirks;
  bool usable() const { return refusal.empty(); }
};

struct ContextOptions {
  // Empty: the first usable device, real GPUs before CPUs. Otherwise an index ("1") or a part of the
  // name or driver, without regard to case ("h200", "lavapipe", "cpu", "gpu"). $QUINTET_DEVICE is used when empty.
  std::string device;
  // Validation layers with synchronization validation; messages are counted and go to the log as
  // warnings. Default: $QUINTET_VALIDATE is set and not "0". A missing layer is an Error.
  bool validate = validationRequested();
  LogSink log;

  static bool validationRequested();
};

class Context {
 public:
  // Throws NoDeviceError when no device fits, naming each device and its refusal.
  explicit Context(const ContextOptions& options = {});
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  // Every device of the machine, usable or not, in the order in which Context would prefer them.
  // No Vulkan loader or driver at all: empty.
  static std::vector<DeviceInfo> devices();

  const DeviceInfo& info() const;
  const VolkDeviceTable& vk() const;
  VkInstance instance() const;
  VkPhysicalDevice physicalDevice() const;
  VkDevice device() const;
  VmaAllocator allocator() const;
  VkQueue queue() const;
  std::uint32_t queueFamily() const;
  const LogSink& log() const;
  DeviceMemory memory() const;  // asked of the driver
  MemoryAccount& memoryAccount();
  PipelineStore& pipelines();

  // Validation messages so far, known false alarms left out (context_validation.cpp lists them).
  std::uint32_t validationMessageCount() const;
  std::vector<std::string> validationMessages() const;

  // Records and submits; returns the timeline value that marks the end of this work.
  // Submissions execute in order; memory is made visible between them.
  std::uint64_t submit(const std::function<void(Commands&)>& record);
  // Blocks until `value` is reached. Throws TimeoutError after timeoutSeconds (≤ 0: no limit).
  void wait(std::uint64_t value, double timeoutSeconds = 0.0);
  void submitAndWait(const std::function<void(Commands&)>& record) { wait(submit(record)); }
  std::uint64_t completed() const;  // last timeline value that has been reached
  std::uint64_t submitted() const;  // last timeline value handed out

  // Runs `destroy` once all work submitted so far has ended (at the latest in the destructor).
  void retire(std::function<void()> destroy);

  // Gives `handle` a name for validation messages and debuggers; nothing without the debug extension.
  void setName(VkObjectType type, std::uint64_t handle, std::string_view name);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet::gpu
#endif
