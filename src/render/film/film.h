// SPDX-License-Identifier: Apache-2.0
// The film of a render on the device. A batch holds samples [k · kBatchSamples, (k+1) · kBatchSamples) of every pixel,
// which the program sums in float32 in sample order. Batch sums are added to the totals in fixed point
// (shared::FixedSum), which is exact and independent of order. The bytes therefore depend neither on launch sizes, nor
// on the order of batches, nor on how many processes rendered them. The first output also stores the squares of its
// batch sums, for its variance. For a program that accumulates (program::Accumulation), a batch is one frame, which
// replaces the total: the previous frame. Its pixels that are not finite are marked.
#ifndef QUINTET_RENDER_FILM_FILM_H
#define QUINTET_RENDER_FILM_FILM_H

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/compute.h"
#include "render/film/film_error.h"
#include "render/film/film_state.h"
#include "shader/compiler.h"

namespace quintet::render {

class Film {
 public:
  // Stores the program's outputs, of the optional ones only those in `wanted`. Throws UsageError for an unknown name in
  // `wanted`.
  Film(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler, Region region,
       const program::Program& program, const std::vector<std::string>& wanted = {});

  const Region& region() const { return region_; }
  const SampleCounts& counts() const { return counts_; }
  bool stores(std::size_t output) const { return outputs_[output].stored; }
  std::uint64_t bytes() const;  // device memory
  // Returns the device memory of a film for this region, program and optional outputs.
  static std::uint64_t bytesFor(const Region& region, const program::Program& program,
                                const std::vector<std::string>& wanted);
  // Sets the film's fields of the frame.
  void describe(shared::Frame& frame) const;

  // Discards all samples and ray counts.
  void clear();
  // The same, and changes the size. Throws MemoryError, and then changes nothing.
  void resize(Region region);

  // Record commands around the launches of a batch or frame: beginBatch clears the batch sums; endBatch adds them to
  // the totals, or replaces the totals by them, and counts the samples.
  void beginBatch(gpu::Commands& commands);
  void endBatch(gpu::Commands& commands, SampleRange samples);
  // The same for rows [first, first + count) of a batch. The samples are not counted (counts()): other films have the rest.
  void beginRows(gpu::Commands& commands, std::uint32_t first, std::uint32_t count);
  void endRows(gpu::Commands& commands, SampleRange samples, std::uint32_t first, std::uint32_t count);
  // The same for at most tileCount() tiles, sorted by batch, of programs with adaptive sampling. Their batches are not batch 0.
  // `address`: of the tiles on the device. The samples are not counted; setCellBatches() does that.
  void beginTiles(gpu::Commands& commands, std::size_t count);
  void endTiles(gpu::Commands& commands, shared::Address address, std::span<const shared::FilmTile> tiles);
  void setCellBatches(std::vector<std::uint32_t> batches);  // SampleCounts::cellBatches

  // Reads the current contents of one output. Blocks.
  FilmPlane plane(std::size_t output) const { return plane(outputs_.at(output)); }
  // Returns planeImage of the current contents. Blocks.
  io::Image download(std::size_t output) const;
  // The same for display, and faster: the device divides, in single precision. Relative error below 1e-6. Not for
  // adaptive films and outputs that count ids. Blocks.
  io::Image downloadMean(std::size_t output) const;
  // Returns the sums of the latest batch, RGBA per pixel in row-major order from the top. Blocks.
  std::vector<vec4> downloadBatch(std::size_t output) const;
  RayCount countRays() const;  // blocks
  // Reads FilmState::statistics. Blocks.
  std::vector<uvec2> downloadStatistics() const;
  // Returns findNotFinite() of the current contents, found on the device. For a program that accumulates, it counts the
  // pixels that were not finite in any frame. Blocks.
  std::vector<NotFinitePixels> notFinitePixels() const;

  // Read the whole film, or its first output only. Block.
  FilmState save() const;
  FilmState saveFirst() const;
  // Returns estimateError of the current contents. Blocks.
  ErrorEstimate estimateError() const;
  // Replaces the contents by a state of the same program, outputs and region.
  void restore(const FilmState& state);

 private:
  struct Output {
    FilmPlane facts;  // name, pixel, kind and color; the arrays are empty
    bool stored = false;
    gpu::Buffer batch, total, squares;  // `total` is empty for an output that is not stored
  };
  void clearValues(gpu::Commands& commands, std::uint64_t first, std::uint64_t count);
  // Adds the values from `value` on to the pixels from `pixel` on, or to those of tiles.
  struct Part {
    std::uint64_t value = 0, pixel = 0;
    std::uint32_t count = 0;
    shared::Address tiles = 0;
  };
  void addPart(gpu::Commands& commands, SampleRange samples, const Part& part);
  FilmPlane plane(const Output& output) const;
  struct Rows {
    std::uint32_t first, count;
    bool squares;  // whether to read the squares as well
  };
  // Reads rows into the arrays of `plane`, whose memory is reused. `staging` (Buffer::makeReadback) can be null.
  void readRows(const Output& output, const Rows& rows, const gpu::Buffer* staging, FilmPlane& plane) const;
  // Reads an output, with or without its squares, tile row by tile row, and calls use(strip, first row of the strip).
  template <class Use>
  void forStrips(const Output& output, bool squares, const Use& use) const;

  gpu::Context& context_;
  Region region_;
  program::Accumulation accumulation_;
  bool adaptive_;  // program::Program::adaptive
  std::vector<Output> outputs_;
  gpu::Buffer statistics_;
  gpu::Buffer marks_;  // of shared::FilmFrame; empty unless the program accumulates
  SampleCounts counts_;
  std::unique_ptr<gpu::ComputePipeline> add_;    // null if the program accumulates
  std::unique_ptr<gpu::ComputePipeline> frame_;  // null unless the program accumulates
  std::unique_ptr<gpu::ComputePipeline> coverage_;
  std::unique_ptr<gpu::ComputePipeline> check_;
  std::unique_ptr<gpu::ComputePipeline> mean_;  // null if the program accumulates
  mutable gpu::Buffer means_, staging_;         // of downloadMean(), which creates them; for one output
};

}  // namespace quintet::render
#endif
