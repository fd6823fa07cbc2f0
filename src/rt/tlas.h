// Top-level acceleration structures.
#ifndef QUINTET_RT_TLAS_H
#define QUINTET_RT_TLAS_H

#include <cstdint>
#include <span>
#include <string>

#include "gpu/commands.h"
#include "rt/blas.h"

namespace quintet::rt {

struct InstanceInput {
  mat4 worldFromObject{1.0f};
  const Blas* blas = nullptr;
  std::uint32_t customIndex = 0;   // 24 bits: gl_InstanceCustomIndexEXT
  std::uint32_t mask = 0xFF;       // 8 bits
  std::uint32_t recordOffset = 0;  // 24 bits: first hit record in the SBT
  VkGeometryInstanceFlagsKHR flags = 0;
};

// Built for up to `capacity` instances and rebuilt (not refitted) as often as wanted, also while the
// device still traces an earlier build: each rebuild has an instance buffer of its own.
class Tlas {
 public:
  Tlas(gpu::Context& context, std::uint32_t capacity, const std::string& name = "tlas");
  ~Tlas();
  Tlas(const Tlas&) = delete;
  Tlas& operator=(const Tlas&) = delete;

  // Records a rebuild with these instances (0 … capacity) and the barriers around it. Instances
  // whose transform is not finite or not invertible, or whose BLAS is empty, are left out.
  // gl_InstanceID is the position after spatial ordering (but see keepInputOrder): use gl_InstanceCustomIndexEXT to identify an
  // instance. Throws UsageError beyond the capacity and for fields that do not fit their bits.
  void build(gpu::Commands& commands, std::span<const InstanceInput> instances);
  void buildAndWait(std::span<const InstanceInput> instances);

  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceSize size() const { return storage_.size(); }
  // gl_InstanceID is the position in the span of the next builds, on every device; inactive instances keep theirs.
  // Costs speed where the driver keeps the order (docs/design/quirks.md).
  void keepInputOrder(bool keep) { keepInputOrder_ = keep; }

 private:
  gpu::Context& context_;
  std::uint32_t capacity_;
  std::string name_;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  gpu::Buffer storage_;
  gpu::Buffer scratch_;
  bool keepInputOrder_ = false;
};

}  // namespace quintet::rt
#endif
