// SPDX-License-Identifier: Apache-2.0
// What a job returns: the film, how it was made, and what that took.
#ifndef QUINTET_JOB_RESULT_H
#define QUINTET_JOB_RESULT_H

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/diagnostic.h"
#include "io/image.h"
#include "job/observer.h"
#include "job/provenance.h"
#include "job/request.h"
#include "render/film/film_error.h"
#include "render/film/film_file.h"

namespace quintet::job {

// The film of a result: on the device while the job exists, or from a file.
class FilmView {
 public:
  virtual ~FilmView() = default;

  // Names, kinds and pixel types of all outputs; their arrays may be empty.
  virtual const std::vector<render::FilmPlane>& planes() const = 0;
  virtual bool stores(std::size_t output) const = 0;
  virtual render::SampleCounts counts() const = 0;
  // Linear, premultiplied RGBA floats: the mean of all samples, or the last frame. Display values are decoded, so that
  // an 8-bit file holds what the program wrote.
  virtual io::Image image(std::size_t output) const = 0;
  virtual render::FilmPlane plane(std::size_t output) const = 0;  // with its arrays
  virtual io::Image variance() const = 0;                         // of the mean of output 0, per channel
  virtual render::FilmState state() const = 0;                    // everything
};

// Of a film in host memory.
std::shared_ptr<const FilmView> viewOf(render::FilmState film, bool transparent);

// Bytes that the process and the device held, and what the scene requires at least.
struct MemoryUse {
  std::uint64_t peakHost = 0;    // resident, up to the end of the render
  std::uint64_t peakDevice = 0;  // allocated by the driver
  std::uint64_t geometry = 0;
  std::uint64_t textures = 0;
  std::uint64_t acceleration = 0;   // structures
  std::uint64_t primitiveMaps = 0;  // where the driver keeps the input order (docs/design/quirks.md)
  // Shares of peakDevice (purpose, bytes) at the moment of the peak; "unused" is free space in the driver's blocks.
  std::vector<std::pair<std::string, std::uint64_t>> devicePeak;
  bool deviceIsHost = false;  // a CPU device: its memory is part of the process's memory

  // Peak / (geometry + textures + acceleration + primitiveMaps). On a CPU device the peak of the process; else the larger of the two
  // peaks, each memory by itself.
  double ratio() const;
};

// Wall clock in seconds, except `device`.
struct Timings {
  double start = 0;       // instance and device
  double load = 0;        // scene and environment: read and decoded
  double build = 0;       // upload and acceleration structures
  double compile = 0;     // GLSL to SPIR-V
  double pipeline = 0;    // SPIR-V to pipeline
  double firstPixel = 0;  // from the start of the process's work to the end of the first launch
  double render = 0;      // all batches, earlier sessions of a resumed render included
  double device = 0;      // of `render`, on the device
  std::vector<std::pair<std::string, double>> stages;  // from the start to the first pixel, in detail
};

struct RenderResult {
  Provenance provenance;
  std::shared_ptr<const FilmView> film;
  std::vector<std::uint32_t> plan;               // of adaptive sampling: render::FilmFile::plan
  bool accumulatesFrames = false;                // the program accumulates: `samples` counts frames
  ReachedLimit reached = ReachedLimit::samples;  // unless `interrupted`
  bool interrupted = false;                      // stopped by the observer before a limit was reached
  bool abandoned = false;                        // StopRequest::abandon: the film is incomplete and must not be used
  bool targetMissed = false;                     // the target error is not reached
  bool earlierTargetMissed = false;              // nor in an earlier frame, whose warnings the observer got
  render::ErrorEstimate error;                   // of output 0
  Timings seconds;
  MemoryUse memory;
  std::uint64_t filmBytes = 0;                     // on the device
  std::vector<render::NotFinitePixels> notFinite;  // outputs with pixels that are not finite
  std::uint32_t recursionDepth = 1;                // of the pipeline
  std::uint64_t skippedTraces = 0;                 // beyond this depth (Q003), of a program whose traces form a cycle
  std::optional<Printed> printed;                  // what an observer collected; unset: not requested
  std::vector<std::string> warnings;
  std::vector<Diagnostic> diagnostics;  // warnings about the program

  double raysPerSecond() const;
};

// Stores what the film counted in the result and its provenance: rays, discarded samples, and pixels that are not
// finite.
void setCounts(RenderResult& result, const render::RayCount& rays, std::vector<render::NotFinitePixels> notFinite);
// Adds the rays, the discarded samples, the skipped traces and the pixels that are not finite in a further frame of an animation.
void addFrame(RenderResult& result, const RenderResult& frame);

// What a user must know about a complete or interrupted render: a missed target error, unless the render was interrupted,
// discarded samples, pixels that are not finite, and skipped traces. Empty if there is nothing to report.
std::vector<std::string> resultWarnings(const RenderResult& result);
// The warnings of resultWarnings() that the shaders caused, without a location: discarded samples, pixels that are not
// finite (Q002), and skipped traces (Q003).
std::vector<Diagnostic> runFindings(const RenderResult& result);

// The result as a film file: what a checkpoint or a part contains.
render::FilmFile filmFileOf(const RenderResult& result);

}  // namespace quintet::job
#endif
