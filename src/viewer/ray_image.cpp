// SPDX-License-Identifier: Apache-2.0
#include "viewer/ray_image.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "job/depth_map.h"
#include "viewer/line_image.h"
#include "viewer/ray_overlay.h"
#include "viewer/window_shaders.h"

namespace quintet::viewer {
namespace {

constexpr float kPlainHeight = 800.0f;  // pixels: widths grow with larger images

}  // namespace

void requireSceneCamera(const job::PixelExplanation& explanation, const scene::Camera& camera) {
  if (usesCamera(explanation, camera)) return;
  throw Error(fmt::format(
      "{}: the first ray of pixel {},{} is not that of the scene's camera, so its rays cannot be drawn over the image",
      explanation.program, explanation.pixel.x, explanation.pixel.y));
}

io::Image drawRays(job::Engine& engine, job::RenderJob& job, const job::PixelExplanation& explanation,
                   const io::Image& image, const std::filesystem::path& caches) {
  const uvec2 size(image.width, image.height);
  const job::DepthMap depth =
      job::renderDepthMap(engine, *job.scene()->onDevice, job.camera(), size, job.resolved().program);
  const float farthest = *std::ranges::max_element(depth.depths);
  const RayOverlay overlay = rayOverlay(explanation, farthest > 0.0f ? farthest : 1.0f);
  OverlayView view{job.camera(), {}};
  view.placement.size = size;
  OverlayStyle style;
  style.scale = std::max(1.0f, static_cast<float>(size.y) / kPlainHeight);
  return drawLines(engine.context(), compileLineShaders(caches), image, overlayLines(overlay, view, style, &depth),
                   size, reversedDepths(depth));
}

}  // namespace quintet::viewer
