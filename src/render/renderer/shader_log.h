// SPDX-License-Identifier: Apache-2.0
// The log to which shaders append records (quintet/log.glsl): its buffer on the device, and its contents on the host.
#ifndef QUINTET_RENDER_RENDERER_SHADER_LOG_H
#define QUINTET_RENDER_RENDERER_SHADER_LOG_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "quintet/shared/log.h"
#include "render/film/film_state.h"

namespace quintet::render {

struct LogRecord {
  std::uint32_t kind = 0;         // shared::kLog…
  uvec2 pixel{0};                 // of the whole image
  std::uint32_t sampleIndex = 0;  // of the pixel, or index of the frame if the program accumulates
  std::size_t firstWord = 0;      // in LogContents::words
  std::size_t wordCount = 0;
};

struct LogContents {
  std::vector<LogRecord> records;  // by pixel (row by row), then by sample, then in the order of the shader's calls
  std::vector<std::uint32_t> words;
  // Records that did not fit. If there are some, the device decided which ones fit, and the order of its invocations can
  // differ in each run.
  std::uint32_t dropped = 0;

  std::span<const std::uint32_t> wordsOf(const LogRecord& record) const {
    return std::span(words).subspan(record.firstWord, record.wordCount);
  }
};

// Returns the records in the words after a LogHeader. Stops at the end mark, or at a record that the words do not contain
// completely.
LogContents parseLog(const shared::LogHeader& header, std::vector<std::uint32_t> words);

class ShaderLog {
 public:
  // The log takes records of the pixels in `pixels`, of the whole image. `capacity` is its size in words, headers of
  // records included (shared::kLogRecordWords each). Throws gpu errors.
  ShaderLog(gpu::Context& context, const Region& pixels, std::uint32_t capacity);

  shared::Address address() const { return buffer_.address(); }
  // Returns the records so far and removes them. The launches that write to the log must have ended
  // (Renderer::finish()). Blocks.
  LogContents take();

 private:
  shared::LogHeader empty_;
  gpu::Buffer buffer_;
};

}  // namespace quintet::render
#endif
