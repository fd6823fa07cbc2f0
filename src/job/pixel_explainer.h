// SPDX-License-Identifier: Apache-2.0
// Records why a sample of a pixel has its value: renders that sample alone, with the program and with a variant of it that
// logs what each stage does (Instrumentation::explain).
#ifndef QUINTET_JOB_PIXEL_EXPLAINER_H
#define QUINTET_JOB_PIXEL_EXPLAINER_H

#include <cstdint>
#include <memory>
#include <optional>

#include "job/engine.h"
#include "job/observer.h"
#include "job/pixel_explanation.h"
#include "job/render_job.h"
#include "job/value_origin.h"
#include "job/view.h"
#include "render/renderer/renderer.h"
#include "render/renderer/shader_log.h"

namespace quintet::job {

// Largest number of a sample or frame that can be explained. Renders have at most 2^24 samples per pixel.
inline constexpr std::uint32_t kMaxSample = (1u << 24) - 1;

// Returns the request of a render for explaining this pixel. Its region is the pixel, unless the program accumulates frames
// and can read those of other pixels. Throws UsageError for a region or a part of a render, which cannot be explained, and
// for a pixel outside of the image if its size is known; if it is not, RenderJob or PixelExplainer::explain() throws.
RenderRequest requestForPixel(RenderRequest request, const program::Program& program, uvec2 pixel);

// The image of which a pixel is explained.
struct ExplainedImage {
  CameraChoice camera;
  uvec2 size{0};  // pixels
};

class PixelExplainer {
 public:
  // The explainer needs exclusive use of `job` and discards its samples. `job` and `engine` must outlive it. Moves the scene
  // to the requested frame. Compiles the variant. Throws ProgramError, UsageError (RenderJob::showRequestedFrame) and gpu
  // errors.
  PixelExplainer(Engine& engine, RenderJob& job);
  // For a job that keeps its samples, and whose edits are on the device (RenderJob::update()): explains only this pixel,
  // of this image. Valid until the next edit of the job. Compiles the program, too. Programs that accumulate move the
  // scene to the explained frame; RenderJob::showCurrentFrame() moves it back.
  PixelExplainer(Engine& engine, RenderJob& job, const ExplainedImage& image, uvec2 pixel);
  PixelExplainer(const PixelExplainer&) = delete;
  PixelExplainer& operator=(const PixelExplainer&) = delete;

  // Explains sample number `sample` (from 0) of a pixel in the region of the job, or frame number `sample` of a program that
  // accumulates, whose earlier frames are rendered first. The pixel has the same random numbers as in the job's render. What
  // the sample prints goes to Observer::printed() if the request of the job asks for it, but not with an ExplainedImage.
  // Throws UsageError for a pixel outside of the image and a sample above kMaxSample. A launch that does not end calls Observer::deviceHung() and throws
  // TimeoutError.
  PixelExplanation explain(uvec2 pixel, std::uint32_t sample, Observer& observer);

 private:
  void makeInstrumented(render::RenderSettings settings);
  void renderEarlierFrames(std::uint32_t count);
  PixelExplanation record(uvec2 pixel, std::uint32_t sample);
  std::optional<ValueOrigin> findOrigin(uvec2 pixel, std::uint32_t sample);
  PixelExplanation facts() const;

  Engine& engine_;
  RenderJob& job_;
  ExplainedImage image_;
  render::ShaderLog log_;
  program::RunnableProgram program_;                // instrumented
  std::unique_ptr<render::Renderer> own_;           // of the program as it is; null if it is that of the job
  render::Renderer& renderer_;                      // of the program as it is
  std::unique_ptr<render::Renderer> instrumented_;  // with program_ and log_
  std::optional<render::FilmState> earlier_;        // of the frames before the explained one
  std::unique_ptr<ValueOriginFinder> origins_;      // of originsOf_; null until a value is not finite
  uvec2 originsOf_{0};
};

}  // namespace quintet::job
#endif
