// SPDX-License-Identifier: Apache-2.0
// Records why a sample of a pixel has its value: renders that sample alone, with the program and with a variant of it that
// logs what each stage does (Instrumentation::explain).
#ifndef QUINTET_JOB_PIXEL_EXPLAINER_H
#define QUINTET_JOB_PIXEL_EXPLAINER_H

#include <cstdint>
#include <memory>

#include "job/engine.h"
#include "job/observer.h"
#include "job/pixel_explanation.h"
#include "job/render_job.h"
#include "render/renderer/renderer.h"
#include "render/renderer/shader_log.h"

namespace quintet::job {

// Returns the request of a render of which only this pixel is explained. Its region is the pixel, unless the program
// accumulates frames and can read those of other pixels. Throws UsageError for a pixel outside of the image, and for a region
// or a part of a render, which cannot be explained.
RenderRequest requestForPixel(RenderRequest request, const program::Program& program, uvec2 pixel);

class PixelExplainer {
 public:
  // `job` is for the explainer alone, which discards its samples, and outlives it, as does `engine`. Compiles the variant.
  // Throws ProgramError and gpu errors.
  PixelExplainer(Engine& engine, RenderJob& job);
  PixelExplainer(const PixelExplainer&) = delete;
  PixelExplainer& operator=(const PixelExplainer&) = delete;

  // Explains sample number `sample` (from 0) of a pixel in the region of the job, or frame number `sample` of a program that
  // accumulates, whose earlier frames are rendered first. The pixel has the same random numbers as in the job's render. A
  // launch that does not end calls Observer::deviceHung() and throws TimeoutError.
  PixelExplanation explain(uvec2 pixel, std::uint32_t sample, Observer& observer);

 private:
  void renderEarlierFrames(std::uint32_t count);
  PixelExplanation record(uvec2 pixel, std::uint32_t sample);
  PixelExplanation facts() const;

  Engine& engine_;
  RenderJob& job_;
  render::ShaderLog log_;
  program::RunnableProgram program_;                // instrumented
  std::unique_ptr<render::Renderer> instrumented_;  // with program_ and log_
};

}  // namespace quintet::job
#endif
