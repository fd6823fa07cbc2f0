// Bottom- and top-level acceleration structures: batched builds with a scratch budget, compaction,
// refit. Primitives are put in a good spatial order first where the driver keeps the input order;
// shaders find the original index through BlasGeometry's primitive map (null: identity).
#ifndef QUINTET_RT_ACCELERATION_STRUCTURE_H
#define QUINTET_RT_ACCELERATION_STRUCTURE_H

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math.h"
#include "gpu/buffer.h"
#include "gpu/commands.h"

namespace quintet::rt {

enum class GeometryKind { triangles, boxes };

// Host data of one geometry; must outlive the build call only.
struct GeometryInput {
  GeometryKind kind = GeometryKind::triangles;
  std::span<const vec3> positions;   // triangles: object space
  std::span<const uvec3> triangles;  // triangles: vertex indices, all in range
  std::span<const Bounds3> boxes;    // boxes
  bool opaque = true;                // no any-hit shader is called
  bool singleAnyHit = false;         // NO_DUPLICATE_ANY_HIT_INVOCATION
};

struct BlasOptions {
  bool fastTrace = true;
  bool allowUpdate = false;   // refit
  bool compact = true;        // where the driver gains by it (and not with allowUpdate)
  bool keepInputOrder = false;  // for benchmarks: no spatial order even where it pays
  std::string name;
};

struct BlasInput {
  std::vector<GeometryInput> geometries;  // ≥ 0; none or all empty gives a BLAS that no ray hits
  BlasOptions options;
};

class Blas {
 public:
  Blas() = default;
  ~Blas();
  Blas(Blas&&) noexcept;
  Blas& operator=(Blas&&) noexcept;

  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceAddress address() const { return address_; }
  VkDeviceSize size() const { return storage_.size(); }   // bytes after compaction
  VkDeviceSize builtSize() const { return builtSize_; }    // bytes before compaction
  const Bounds3& bounds() const { return bounds_; }        // object space, of all geometries
  // For geometry g: device address of a uint per built primitive: gl_PrimitiveID → index in the
  // input; 0 where both are the same.
  VkDeviceAddress primitiveMap(std::size_t geometry) const { return maps_[geometry]; }
  // Primitives with non-finite vertices or boxes, left out of the build.
  std::uint32_t inactiveCount() const { return inactiveCount_; }

 private:
  friend class BlasBuilder;
  void release();
  gpu::Context* context_ = nullptr;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  VkDeviceAddress address_ = 0;
  VkDeviceSize builtSize_ = 0;
  gpu::Buffer storage_;
  gpu::Buffer mapStorage_;
  std::vector<VkDeviceAddress> maps_;
  std::vector<std::vector<std::uint32_t>> order_;  // host copy, kept only with allowUpdate
  Bounds3 bounds_;
  std::uint32_t inactiveCount_ = 0;
  BlasOptions options_;
};

struct BuildStatistics {
  double orderSeconds = 0;    // host: spatial order
  double buildSeconds = 0;    // wall clock of builds and compaction
  std::uint64_t primitiveCount = 0;
  std::uint32_t batchCount = 0;
  VkDeviceSize peakScratchBytes = 0;
  VkDeviceSize bytes = 0;     // all BLAS after compaction
};

class BlasBuilder {
 public:
  // scratchBudget: bytes of scratch memory that builds of one batch may share (a single larger build
  // gets what it needs).
  explicit BlasBuilder(gpu::Context& context, VkDeviceSize scratchBudget = VkDeviceSize{64} << 20);

  // Builds all, in as few submissions as the budget allows; result k belongs to inputs[k]. Blocks.
  std::vector<Blas> build(std::span<const BlasInput> inputs, BuildStatistics* statistics = nullptr);

  // Rebuilds `blas` in place for moved vertices or boxes: same counts and indices as it was built
  // with, and it must have been built with allowUpdate. Blocks.
  void refit(Blas& blas, const BlasInput& moved);

 private:
  gpu::Context& context_;
  VkDeviceSize scratchBudget_;
};

struct InstanceInput {
  mat4 worldFromObject{1.0f};
  const Blas* blas = nullptr;
  std::uint32_t customIndex = 0;         // 24 bits: gl_InstanceCustomIndexEXT
  std::uint32_t mask = 0xFF;             // 8 bits
  std::uint32_t recordOffset = 0;        // 24 bits: first hit record in the SBT
  VkGeometryInstanceFlagsKHR flags = 0;
};

// Built for up to `capacity` instances and rebuilt (not refitted) as often as wanted.
class Tlas {
 public:
  Tlas(gpu::Context& context, std::uint32_t capacity, const std::string& name = "tlas");
  ~Tlas();
  Tlas(const Tlas&) = delete;
  Tlas& operator=(const Tlas&) = delete;

  // Records a rebuild with these instances (0 … capacity) and the barriers around it. Instances
  // whose transform is not finite or not invertible are left out. gl_InstanceID is the position after
  // spatial ordering: use gl_InstanceCustomIndexEXT to identify an instance.
  void build(gpu::Commands& commands, std::span<const InstanceInput> instances);
  void buildAndWait(std::span<const InstanceInput> instances);

  VkAccelerationStructureKHR handle() const { return handle_; }
  VkDeviceSize size() const { return storage_.size(); }
  // For the benchmark only: do not order instances.
  void keepInputOrder(bool keep) { keepInputOrder_ = keep; }

 private:
  gpu::Context& context_;
  std::uint32_t capacity_;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  gpu::Buffer storage_;
  gpu::Buffer scratch_;
  std::vector<gpu::Buffer> instances_;  // ring: the host writes one while the device reads another
  std::size_t next_ = 0;
  bool keepInputOrder_ = false;
};

}  // namespace quintet::rt
#endif
