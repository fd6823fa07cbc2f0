// SPDX-License-Identifier: Apache-2.0
// Top-level acceleration structures and their instances.
#ifndef QUINTET_RT_TLAS_H
#define QUINTET_RT_TLAS_H

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math.h"
#include "gpu/commands.h"
#include "rt/blas.h"

namespace quintet::rt {

struct InstanceInput {
  mat4 worldFromObject{1.0f};
  const Blas* blas = nullptr;
  std::uint32_t customIndex = 0;   // 24 bits, gl_InstanceCustomIndexEXT
  std::uint32_t mask = 0xFF;       // 8 bits
  std::uint32_t recordOffset = 0;  // 24 bits, index of the first hit record in the SBT
  VkGeometryInstanceFlagsKHR flags = 0;
};

// Returns false for an instance that is not part of the build: its mask is 0, its transform is not finite or not
// invertible, or its BLAS is empty.
bool isActive(const InstanceInput& instance);

// Throws UsageError if a field does not fit into its bits.
VkAccelerationStructureInstanceKHR packInstance(const InstanceInput& instance);

enum class InstanceOrder {
  spatial,  // active instances in spatial order
  given,    // active instances in the given order
  numbered  // all instances, so that gl_InstanceID is the index; inactive ones have the BLAS `hidden`
};
// `hidden`: a BLAS that no ray hits, for InstanceOrder::numbered.
std::vector<VkAccelerationStructureInstanceKHR> packInstances(std::span<const InstanceInput> instances,
                                                              InstanceOrder order, const Blas* hidden = nullptr);

// A TLAS for up to `capacity` instances. It can be rebuilt (not refitted) at any time, even while the device traces an
// earlier build, because each rebuild uses its own instance buffer.
class Tlas {
 public:
  Tlas(gpu::Context& context, std::uint32_t capacity, const std::string& name = "tlas");
  ~Tlas();
  Tlas(const Tlas&) = delete;
  Tlas& operator=(const Tlas&) = delete;

  // Records a rebuild with these instances and the barriers before and after it. Inactive instances (isActive) are
  // skipped. gl_InstanceID is the position after spatial sorting unless keepInputOrder is set; use
  // gl_InstanceCustomIndexEXT to identify an instance. Throws UsageError for more than `capacity` instances and for
  // fields that do not fit into their bits.
  void build(gpu::Commands& commands, std::span<const InstanceInput> instances);
  void buildAndWait(std::span<const InstanceInput> instances);

  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceSize size() const { return storage_.size(); }
  // Makes gl_InstanceID the index in the span for the next builds, on every device, also with inactive instances.
  // Tracing is slower with drivers that keep the input order (docs/design/quirks.md).
  void keepInputOrder(bool keep);

 private:
  gpu::Context& context_;
  std::uint32_t capacity_;
  std::string name_;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  gpu::Buffer storage_;
  gpu::Buffer scratch_;
  bool keepInputOrder_ = false;
  std::optional<Blas> hidden_;  // replaces inactive instances if they keep their numbers
};

}  // namespace quintet::rt
#endif
