// Bottom-level acceleration structures: batched builds with a scratch budget, compaction, refit.
// Primitives are put in a good spatial order first where the driver keeps the input order; shaders find
// the original index through Blas::primitiveMap.
#ifndef QUINTET_RT_BLAS_H
#define QUINTET_RT_BLAS_H

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/math.h"
#include "gpu/buffer.h"

namespace quintet::rt {

struct BlasData;  // geometry_data.h

enum class GeometryKind { triangles, boxes };

// Host data of one geometry; must outlive the build call only.
struct GeometryInput {
  GeometryKind kind = GeometryKind::triangles;
  std::span<const vec3> positions;   // triangles: object space
  std::span<const uvec3> triangles;  // triangles: vertex indices, all in range
  std::span<const Bounds3> boxes;    // boxes
  bool opaque = true;                // no any-hit shader is called
  bool singleAnyHit = false;         // NO_DUPLICATE_ANY_HIT_INVOCATION
  // Where the device has the same arrays already, in buffers of usage ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY; 0:
  // they are uploaded for the build.
  VkDeviceAddress positionsAddress = 0;
  VkDeviceAddress trianglesAddress = 0;
};

struct BlasOptions {
  bool fastTrace = true;
  bool allowUpdate = false;     // refit
  bool compact = true;          // where the driver gains by it (and not with allowUpdate)
  bool keepInputOrder = false;  // for benchmarks: no spatial order even where it pays
  std::string name;
};

struct BlasInput {
  // One kind (Vulkan does not mix triangles and boxes in a BLAS); none or all empty gives a BLAS that
  // no ray hits. Geometries may share one positions span: it is uploaded once.
  std::vector<GeometryInput> geometries;
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
  VkDeviceSize size() const { return storage_.size(); }         // bytes after compaction
  VkDeviceSize builtSize() const { return builtSize_; }         // bytes before compaction
  VkDeviceSize mapBytes() const { return mapStorage_.size(); }  // of the primitive maps
  const Bounds3& bounds() const { return bounds_; }             // object space, of all geometries
  // For geometry g: device address of a uint per built primitive: gl_PrimitiveID → index in the
  // input; 0 where both are the same.
  VkDeviceAddress primitiveMap(std::size_t geometry) const { return maps_[geometry]; }
  // Primitives with non-finite vertices or boxes (or a box with min > max), left out of the build.
  std::uint32_t inactiveCount() const { return inactiveCount_; }

 private:
  friend class BlasBuilder;
  friend class BlasBatch;
  // What a refit has to match.
  struct BuiltGeometry {
    GeometryKind kind = GeometryKind::triangles;
    std::size_t vertexCount = 0;
    std::size_t inputCount = 0;      // primitives in the input
    std::uint32_t builtCount = 0;    // primitives in the build
    std::vector<std::uint32_t> map;  // empty: identity
  };
  void release();
  gpu::Context* context_ = nullptr;
  VkAccelerationStructureKHR handle_ = VK_NULL_HANDLE;
  VkDeviceAddress address_ = 0;
  VkDeviceSize builtSize_ = 0;
  gpu::Buffer storage_;
  gpu::Buffer mapStorage_;
  std::vector<VkDeviceAddress> maps_;
  std::vector<BuiltGeometry> built_;  // kept only with allowUpdate
  Bounds3 bounds_;
  std::uint32_t inactiveCount_ = 0;
  BlasOptions options_;
};

struct BuildStatistics {
  double orderSeconds = 0;  // host: spatial order
  double buildSeconds = 0;  // wall clock of builds and compaction
  std::uint64_t primitiveCount = 0;
  std::uint32_t batchCount = 0;
  VkDeviceSize peakScratchBytes = 0;
  VkDeviceSize bytes = 0;  // all BLAS after compaction
};

class BlasBuilder {
 public:
  // scratchBudget: bytes of scratch memory that builds of one batch may share (a single larger build
  // gets what it needs).
  explicit BlasBuilder(gpu::Context& context, VkDeviceSize scratchBudget = VkDeviceSize{64} << 20);

  // Builds all, in as few submissions as the budget allows; result k belongs to inputs[k]. Blocks.
  // Throws UsageError beyond the device's limits and for mixed kinds.
  std::vector<Blas> build(std::span<const BlasInput> inputs, BuildStatistics* statistics = nullptr);

  // Rebuilds `blas` in place for moved vertices or boxes: same counts and indices as it was built
  // with, and it must have been built with allowUpdate; else, or if a built primitive is no longer
  // finite, UsageError. Blocks. The device must not be using `blas`.
  void refit(Blas& blas, const BlasInput& moved);

 private:
  static void remember(Blas& blas, const BlasInput& input, const BlasData& data);
  gpu::Context& context_;
  VkDeviceSize scratchBudget_;
};

}  // namespace quintet::rt
#endif
