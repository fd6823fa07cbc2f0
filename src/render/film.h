// The image while it is being made. A batch holds samples [k · kBatchSamples, (k+1) · kBatchSamples) of every pixel,
// summed in float32 in sample order by the program; batch sums are added to the totals in fixed point
// (shared::FixedSum), which is exact whatever the order. So the bytes depend neither on launch sizes, nor on the order of
// batches, nor on how many processes shared them. The first output keeps the squares of its batch sums, too: its variance.
// Where the program accumulates, a batch is one frame, which then replaces the total: the frame before.
#ifndef QUINTET_RENDER_FILM_H
#define QUINTET_RENDER_FILM_H

#include <memory>
#include <string>
#include <vector>

#include "gpu/compute.h"
#include "render/film_error.h"
#include "render/film_state.h"
#include "shader/compiler.h"

namespace quintet::render {

struct RayCount {
  std::uint64_t rays = 0;
  std::uint64_t droppedSamples = 0;  // not finite
};

class Film {
 public:
  // Of the program's optional outputs only those in `wanted` are kept; unknown names: UsageError.
  Film(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler, Region region,
       const program::Program& program, const std::vector<std::string>& wanted = {});

  const Region& region() const { return region_; }
  const SampleCounts& counts() const { return counts_; }
  bool stores(std::size_t output) const { return static_cast<bool>(outputs_[output].total); }
  std::uint64_t bytes() const;  // device memory
  // Of a film per pixel, for the same program and wish.
  static std::uint64_t bytesPerPixel(const program::Program& program, const std::vector<std::string>& wanted);
  // Fills the frame's film fields.
  void describe(shared::Frame& frame) const;

  // Everything as at the beginning: no sample, no ray.
  void clear();

  // Recorded around the launches of a batch or frame: empties the batch sums; adds them to the total, or puts them
  // in its place. `cells`: the cells that took part, of an adaptive batch (SampleCounts::cellBatches after it).
  void beginBatch(gpu::Commands& commands);
  void endBatch(gpu::Commands& commands, SampleRange samples);
  void endAdaptiveBatch(gpu::Commands& commands, SampleRange samples, const std::vector<std::uint32_t>& cellBatches);

  // What one output holds now. Blocks.
  FilmPlane plane(std::size_t output) const { return plane(outputs_.at(output)); }
  // planeImage of what is there now. Blocks.
  io::Image download(std::size_t output) const;
  // Sums of the batch that ended last, RGBA per pixel, rows from the top. Blocks.
  std::vector<vec4> downloadBatch(std::size_t output) const;
  RayCount countRays() const;  // blocks

  // All of it, or only the first output. Blocks.
  FilmState save() const;
  FilmState saveFirst() const;
  // estimateError of what is there now. Blocks.
  ErrorEstimate estimateError() const;
  // Goes on from a state of the same program, outputs and region.
  void restore(const FilmState& state);

 private:
  struct Output {
    std::string name;
    program::OutputPixel pixel = program::OutputPixel::mean;
    gpu::Buffer batch, total, squares;  // total empty: not stored
  };
  void addBatch(gpu::Commands& commands, SampleRange samples);
  FilmPlane plane(const Output& output) const;
  struct Rows {
    std::uint32_t first, count;
    bool squares;  // too
  };
  // Into a plane that may be used again; `staging` (Buffer::makeReadback) may be null.
  void readRows(const Output& output, const Rows& rows, const gpu::Buffer* staging, FilmPlane& plane) const;
  // Reads an output, with its squares or without, tile row by tile row: use(strip, its first row).
  template <class Use>
  void forStrips(const Output& output, bool squares, const Use& use) const;

  gpu::Context& context_;
  Region region_;
  program::Accumulation accumulation_;
  std::vector<Output> outputs_;
  gpu::Buffer statistics_;
  SampleCounts counts_;
  std::unique_ptr<gpu::ComputePipeline> add_;
  std::unique_ptr<gpu::ComputePipeline> coverage_;
};

}  // namespace quintet::render
#endif
