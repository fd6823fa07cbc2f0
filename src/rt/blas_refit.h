// SPDX-License-Identifier: Apache-2.0
// Repeated updates of a BLAS whose vertices the device moves. What an update needs is prepared once, so that each one
// takes the same time and memory.
#ifndef QUINTET_RT_BLAS_REFIT_H
#define QUINTET_RT_BLAS_REFIT_H

#include "gpu/commands.h"
#include "rt/acceleration_structure.h"
#include "rt/blas.h"

namespace quintet::rt {

class BlasRefit {
 public:
  BlasRefit() = default;
  // `built`: the input of the last build of `blas`, triangles with the addresses of positions and triangles on the
  // device. The host triangles are read during construction only. Throws UsageError for a BLAS without allowUpdate and
  // for counts that differ from the build.
  BlasRefit(gpu::Context& context, const Blas& blas, const BlasInput& built);

  // Records an update of the BLAS in place, without barriers. All vertices must be finite. The BLAS must be the built
  // one; it can have been moved to another object.
  void record(gpu::Commands& commands) const;
  // Device memory in bytes: scratch memory, and sorted triangles for drivers that keep the input order.
  VkDeviceSize bytes() const { return (triangles_ ? triangles_.size() : 0) + (scratch_ ? scratch_.size() : 0); }

 private:
  void addTriangles(gpu::Context& context, const std::vector<GeometryData>& geometries);

  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  BuildDescription description_;
  gpu::Buffer triangles_;  // in the order of the build; empty if that is the order of the input
  gpu::Buffer scratch_;
};

}  // namespace quintet::rt
#endif
