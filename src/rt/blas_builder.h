// SPDX-License-Identifier: Apache-2.0
// Builds bottom-level acceleration structures in batches with a scratch budget, compacts and refits them.
#ifndef QUINTET_RT_BLAS_BUILDER_H
#define QUINTET_RT_BLAS_BUILDER_H

#include <cstdint>
#include <span>
#include <vector>

#include "rt/blas.h"

namespace quintet::rt {

struct BuildStatistics {
  double orderSeconds = 0;  // host time for the spatial order
  double buildSeconds = 0;  // wall-clock time of builds and compaction
  std::uint64_t primitiveCount = 0;
  std::uint32_t batchCount = 0;
  VkDeviceSize peakScratchBytes = 0;
  VkDeviceSize bytes = 0;  // of all BLAS after compaction
};

class BlasBuilder {
 public:
  // The builds of one batch share at most `scratchBudget` bytes of scratch memory. A single larger build gets what it
  // needs.
  explicit BlasBuilder(gpu::Context& context, VkDeviceSize scratchBudget = VkDeviceSize{64} << 20);

  // Builds all inputs in as few submissions as the budget allows and waits. Result k belongs to inputs[k]. Throws
  // UsageError for inputs above the limits of the device and for mixed kinds.
  std::vector<Blas> build(std::span<const BlasInput> inputs, BuildStatistics* statistics = nullptr);

  // Updates `blas` in place for moved vertices or boxes and waits. The counts and indices must equal those of the
  // build, the BLAS needs allowUpdate, and every built primitive must still be finite; otherwise throws UsageError. The
  // device must not use `blas` meanwhile.
  void refit(Blas& blas, const BlasInput& moved);

 private:
  static void keepForRefit(Blas& blas, const BlasInput& input, const BlasData& data);

  gpu::Context& context_;
  VkDeviceSize scratchBudget_;
};

}  // namespace quintet::rt
#endif
