// The image while it is being made. Samples are summed in float32 in fixed batches: a batch holds samples
// [k · kBatchSamples, (k+1) · kBatchSamples) of every pixel, added in sample order; batch sums are added to
// the total in batch order. So the bytes do not depend on launch sizes, nor on which device renders which batch.
// Where the program accumulates, a batch is one frame, which then replaces the total: the frame before.
#ifndef QUINTET_RENDER_FILM_H
#define QUINTET_RENDER_FILM_H

#include <string>
#include <vector>

#include "gpu/compute.h"
#include "io/image.h"
#include "program/program.h"
#include "quintet/shared/frame.h"
#include "shader/compiler.h"

namespace quintet::render {

inline constexpr std::uint32_t kBatchSamples = 4;

// Part of an image in pixels from the top left corner.
struct Region {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
};

struct RayCount {
  std::uint64_t rays = 0;
  std::uint64_t droppedSamples = 0;  // not finite
};

class Film {
 public:
  Film(gpu::Context& context, const gpu::BindlessSet& set, const shader::Compiler& compiler, Region region,
       const std::vector<std::string>& outputs, program::Accumulation accumulation = program::Accumulation::film);

  const Region& region() const { return region_; }
  std::uint64_t bytes() const;  // device memory
  // Fills the frame's film fields.
  void describe(shared::Frame& frame) const;

  // Everything as at the beginning: no sample, no ray.
  void clear();

  // Recorded around the launches of a batch or frame: empties the batch sums; adds them to the total, or puts them
  // in its place.
  void beginBatch(gpu::Commands& commands);
  void endBatch(gpu::Commands& commands);

  // RGBA linear floats, premultiplied: total / sampleCount; the last frame as it is where the program accumulates. Blocks.
  io::Image download(std::size_t output, std::uint64_t sampleCount) const;
  // Sums of the batch that ended last, RGBA per pixel, rows from the top. Blocks.
  std::vector<vec4> downloadBatch(std::size_t output) const;
  RayCount countRays() const;  // blocks

 private:
  gpu::Context& context_;
  Region region_;
  std::vector<std::string> outputs_;
  program::Accumulation accumulation_;
  std::vector<gpu::Buffer> batch_;
  std::vector<gpu::Buffer> total_;
  gpu::Buffer statistics_;
  std::unique_ptr<gpu::ComputePipeline> add_;
};

}  // namespace quintet::render
#endif
