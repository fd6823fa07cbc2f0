// SPDX-License-Identifier: Apache-2.0
// Runtime checks: the device buffer of an instrumented program (program/instrument.h), and the diagnostics that its
// contents and the film give.
#ifndef QUINTET_RENDER_RENDERER_INSTRUMENT_H
#define QUINTET_RENDER_RENDERER_INSTRUMENT_H

#include <vector>

#include "gpu/buffer.h"
#include "program/runnable_program.h"
#include "program/scene_facts.h"
#include "quintet/shared/instrument.h"
#include "render/film/film.h"

namespace quintet::render {

struct InstrumentData {
  shared::Instrument counts;
  shared::InstrumentReport reports[shared::kInstrumentReports];
};

class InstrumentBuffer {
 public:
  // `pixels` is the number of pixels of the film, and `depthLimit` the recursion depth of the pipeline. The shader binding
  // table has the shaders of `program`, and hit records of `facts` for each ray type.
  InstrumentBuffer(gpu::Context& context, std::uint64_t pixels, std::uint32_t depthLimit,
                   const program::Program& program, const program::SceneFacts& facts);
  shared::Address address() const { return buffer_.address(); }
  InstrumentData download() const;  // blocks

 private:
  gpu::Buffer buffer_;
};

// The device buffer of a program that counts its recursion (Instrumentation::recursion).
class RecursionBuffer {
 public:
  RecursionBuffer(gpu::Context& context, const Region& region);
  shared::Address address() const { return buffer_.address(); }
  std::uint32_t skippedTraces() const;  // since the construction, modulo 2^32; blocks

 private:
  gpu::Buffer buffer_;
};

// Returns diagnostics Q001 and Q003 to Q007. Q004 (hit records or shaders beyond the table) uses the table of the
// scene. Reports from the same source location are merged into one diagnostic with their number and the first pixel.
std::vector<Diagnostic> instrumentDiagnostics(const InstrumentData& data, const program::RunnableProgram& runnable,
                                              const program::SceneFacts& facts);

// Returns diagnostics Q002: pixels of the film that are not finite (Film::notFinitePixels), and samples that the program
// dropped for that reason. Blocks.
std::vector<Diagnostic> outputDiagnostics(const program::Program& program, const Film& film);

}  // namespace quintet::render
#endif
