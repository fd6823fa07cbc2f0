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

  // A new BLAS; `options` and `data` must outlive run().
  void add(const BlasOptions& options, const BlasData& data);
  // An update of `target` in place.
  void addRefit(Blas& target, const BlasData& data);
  // Uploads, builds, compacts and waits. Result k belongs to the k-th add.
  std::vector<Blas> run();
  VkDeviceSize scratchBytes() const { return scratchBytes_; }

 private:
  struct Job {
    const BlasOptions* options;
    const BlasData* data;
    bool refit;
    Blas* target;  // of a build: set by run()
    BuildDescription description;
    VkAccelerationStructureBuildSizesInfoKHR sizes;
    VkDeviceSize scratchOffset;
  };
  using HostBytes = std::span<const std::byte>;

  void addJob(const BlasOptions& options, const BlasData& data, Blas* refitted);
  VkDeviceSize place(HostBytes data);
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
  VkDeviceSize inputBytes_ = 0;
  VkDeviceSize scratchBytes_ = 0;
  std::optional<BufferFiller> filler_;
  gpu::Buffer inputs_;
  gpu::Buffer scratch_;
};

}  // namespace quintet::rt
#endif
