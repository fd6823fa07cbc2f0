// SPDX-License-Identifier: Apache-2.0
// A bottom-level acceleration structure; blas_builder.h builds them.
#ifndef QUINTET_RT_BLAS_H
#define QUINTET_RT_BLAS_H

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gpu/buffer.h"
#include "rt/blas_input.h"

namespace quintet::rt {

class Blas {
 public:
  Blas() = default;
  ~Blas();
  Blas(Blas&&) noexcept;
  Blas& operator=(Blas&&) noexcept;

  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceAddress address() const { return address_; }
  VkDeviceSize size() const { return storage_.size(); }         // bytes after compaction
  VkDeviceSize builtSize() const { return builtSize_; }         // bytes before compaction
  VkDeviceSize mapBytes() const { return mapStorage_.size(); }  // of the primitive maps
  const Bounds3& bounds() const { return bounds_; }             // of all geometries, object space
  void setBounds(const Bounds3& bounds) { bounds_ = bounds; }   // after a BlasRefit
  // Device address of an array of uints that maps gl_PrimitiveID of a geometry to the index in the input; 0 if both are
  // equal.
  VkDeviceAddress primitiveMap(std::size_t geometry) const { return maps_[geometry]; }
  std::size_t geometryCount() const { return maps_.size(); }
  // Number of inactive primitives, which are not part of the build (prepareBlas).
  std::uint32_t inactiveCount() const { return inactiveCount_; }

 private:
  friend class BlasBuilder;
  friend class BlasBatch;
  friend class BlasRefit;
  // Counts that a refit must match.
  struct BuiltGeometry {
    GeometryKind kind = GeometryKind::triangles;
    std::size_t vertexCount = 0;
    std::size_t inputCount = 0;      // primitives of the input
    std::uint32_t builtCount = 0;    // primitives of the build
    std::vector<std::uint32_t> map;  // empty means the identity
  };
  void release();

  gpu::Context* context_ = nullptr;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  VkDeviceAddress address_ = 0;
  VkDeviceSize builtSize_ = 0;
  gpu::Buffer storage_;
  gpu::Buffer mapStorage_;
  std::vector<VkDeviceAddress> maps_;
  std::vector<BuiltGeometry> built_;  // empty without allowUpdate
  Bounds3 bounds_;
  std::uint32_t inactiveCount_ = 0;
  BlasOptions options_;
};

}  // namespace quintet::rt
#endif
