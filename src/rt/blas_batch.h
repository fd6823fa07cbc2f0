// The device side of several BLAS builds (or refits) that share a submission, an input buffer and
// scratch memory.
#ifndef QUINTET_RT_BLAS_BATCH_H
#define QUINTET_RT_BLAS_BATCH_H

#include <map>

#include "gpu/commands.h"
#include "rt/buffer_filler.h"
#include "rt/build_description.h"

namespace quintet::rt {

class BlasBatch {
 public:
  explicit BlasBatch(gpu::Context& context) : context_(context) {}

  // A new BLAS; `options` and `data` must outlive run(), which empties the maps of `data` unless the BLAS may be
  // updated.
  void add(const BlasOptions& options, BlasData& data);
  // An update of `target` in place.
  void addRefit(Blas& target, BlasData& data);
  // Uploads, builds, compacts and waits. Result k belongs to the k-th add.
  std::vector<Blas> run();
  VkDeviceSize scratchBytes() const { return scratchBytes_; }

 private:
  // On the device already (an address), or at an offset of the input buffer.
  struct Place {
    VkDeviceAddress address = 0;
    VkDeviceSize offset = 0;
  };
  struct GeometryPlaces {
    Place points;  // or boxes
    Place indices;
  };
  struct Job {
    const BlasOptions* options;
    BlasData* data;
    bool refit;
    Blas* target;  // of a build: set by run()
    BuildDescription description;
    VkAccelerationStructureBuildSizesInfoKHR sizes;
    VkDeviceSize scratchOffset;
    std::vector<GeometryPlaces> places;  // one per geometry
  };
  using HostBytes = std::span<const std::byte>;

  void addJob(const BlasOptions& options, BlasData& data, Blas* refitted);
  Place place(VkDeviceAddress known, HostBytes data);
  GeometryPlaces placesOf(const GeometryData& geometry);
  void uploadInputs();
  void describe(Job& job);
  Blas create(const Job& job);
  void uploadMaps(const BlasData& data, Blas& blas);
  void recordBuilds(gpu::Commands& commands) const;
  // Of the new structures that are to be compacted: sizes by query, then copies (blas_compaction.cpp).
  void compact(std::span<Blas* const> structures) const;
  std::vector<VkDeviceSize> compactedSizes(std::span<Blas* const> structures) const;

  gpu::Context& context_;
  std::vector<Job> jobs_;
  std::map<std::pair<const std::byte*, std::size_t>, VkDeviceSize> places_;  // byte in the input buffer
  std::vector<std::pair<const GeometryData*, VkDeviceSize>> gathered_;       // primitives in their own order, and where
  VkDeviceSize inputBytes_ = 0;
  VkDeviceSize scratchBytes_ = 0;
  std::optional<BufferFiller> filler_;
  gpu::Buffer inputs_;
  gpu::Buffer scratch_;
};

}  // namespace quintet::rt
#endif
