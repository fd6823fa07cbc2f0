// SPDX-License-Identifier: Apache-2.0
#include "rt/blas.h"

#include <utility>

#include "rt/acceleration_structure.h"

namespace quintet::rt {

Blas::~Blas() { release(); }
Blas::Blas(Blas&& other) noexcept { *this = std::move(other); }

Blas& Blas::operator=(Blas&& other) noexcept {
  if (this == &other) return *this;
  release();
  context_ = std::exchange(other.context_, nullptr);
  handle_ = std::exchange(other.handle_, VkAccelerationStructureKHR{VK_NULL_HANDLE});
  address_ = std::exchange(other.address_, 0);
  builtSize_ = std::exchange(other.builtSize_, 0);
  storage_ = std::move(other.storage_);
  mapStorage_ = std::move(other.mapStorage_);
  maps_ = std::move(other.maps_);
  built_ = std::move(other.built_);
  bounds_ = std::exchange(other.bounds_, Bounds3{});
  inactiveCount_ = std::exchange(other.inactiveCount_, 0);
  options_ = std::move(other.options_);
  return *this;
}

void Blas::release() {
  if (handle_) retireStructure(*context_, handle_);
  handle_ = VK_NULL_HANDLE;
}

}  // namespace quintet::rt
