// The device's notes of an instrumented program, and what they mean.
#ifndef QUINTET_RENDER_INSTRUMENT_H
#define QUINTET_RENDER_INSTRUMENT_H

#include <vector>

#include "gpu/buffer.h"
#include "program/link.h"
#include "quintet/shared/instrument.h"

namespace quintet::render {

struct InstrumentNotes {
  shared::Instrument counts;
  shared::InstrumentReport reports[shared::kInstrumentReports];
};

class InstrumentBuffer {
 public:
  // For a film of `pixels` pixels, a pipeline of this depth and a table with so many miss shaders.
  InstrumentBuffer(gpu::Context& context, std::uint64_t pixels, std::uint32_t depthLimit, std::size_t missCount);
  shared::Address address() const { return buffer_.address(); }
  InstrumentNotes download() const;  // blocks

 private:
  gpu::Buffer buffer_;
};

// The file of a stage that its author knows: the one file of the lecture form for all its stages.
std::string sourceFile(const program::Program& program, const std::string& stage);

// Diagnostics Q001, Q003 … Q006; Q004 by the scene's table: records that no instance has, misses that are not there.
// Several reports of one place are one diagnostic with their number and the first pixel.
std::vector<shader::Diagnostic> instrumentDiagnostics(const InstrumentNotes& notes, const program::Program& program,
                                                      const program::CompiledProgram& compiled,
                                                      const program::SceneFacts& facts);

}  // namespace quintet::render
#endif
