// SPDX-License-Identifier: Apache-2.0
// What a program prints during a job: the log on the device, and the lines for the observer.
#ifndef QUINTET_JOB_PRINT_LOG_H
#define QUINTET_JOB_PRINT_LOG_H

#include <cstdint>
#include <optional>

#include "job/observer.h"
#include "job/request.h"
#include "program/probes.h"
#include "render/renderer/shader_log.h"

namespace quintet::job {

// What the sample indices of records mean.
struct PrintNumbers {
  bool accumulates = false;            // the program accumulates: they are frames
  std::optional<std::uint32_t> frame;  // otherwise they are samples; of this frame of an animation
};

// Returns the lines of the records, at most `limit`.
Printed printedLines(const render::LogContents& log, const program::PrintTable& table, const PrintNumbers& numbers,
                     std::uint64_t limit);

// Returns the pixels of a request. `rendered`: the rendered part of the image. Throws UsageError for pixels outside of it.
render::Region printedPixels(const PrintRequest& request, const render::Region& rendered);

class PrintLog {
 public:
  // Throws UsageError as printedPixels() does, and gpu errors.
  PrintLog(gpu::Context& context, const PrintRequest& request, const render::Region& rendered,
           program::PrintTable table);

  const render::ShaderLog& log() const { return log_; }
  // Passes what was printed since the last call to the observer. The launches must have ended (Renderer::finish()).
  void flush(Observer& observer, const PrintNumbers& numbers);
  // Discards what was printed since then, of a batch that was canceled.
  void discard() { log_.take(); }
  // The same, and counts from 0 to the limit again.
  void restart();

 private:
  render::ShaderLog log_;
  program::PrintTable table_;
  std::uint64_t limit_;
  std::uint64_t remaining_;  // lines until the limit
};

}  // namespace quintet::job
#endif
