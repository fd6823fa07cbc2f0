// SPDX-License-Identifier: Apache-2.0
#include "overlay/ray_image.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "overlay/line_image.h"
#include "overlay/ray_overlay.h"
#include "overlay/window_shaders.h"

namespace quintet::overlay {
namespace {

constexpr float kPlainHeight = 800.0f;  // pixels: widths grow with larger images

}  // namespace

void requireSceneCamera(const job::PixelExplanation& explanation, const scene::Camera& camera) {
  if (usesCamera(explanation, camera)) return;
  throw Error(fmt::format(
      "{}: the first ray of pixel {},{} is not that of the scene's camera, so its rays cannot be drawn over the image",
      explanation.program, explanation.pixel.x, explanation.pixel.y));
}

io::Image drawRays(gpu::Context& context, const job::PixelExplanation& explanation, const job::DepthMap& depth,
                   const io::Image& image, const std::filesystem::path& caches) {
  const uvec2 size(image.width, image.height);
  const float farthest = *std::ranges::max_element(depth.depths);
  const RayOverlay overlay = rayOverlay(explanation, farthest > 0.0f ? farthest : 1.0f);
  OverlayView view{depth.camera, {}};
  view.placement.size = size;
  OverlayStyle style;
  style.scale = std::max(1.0f, static_cast<float>(size.y) / kPlainHeight);
  return drawLines(context, compileLineShaders(caches), image, overlayLines(overlay, view, style, &depth), depth.size,
                   reversedDepths(depth));
}

}  // namespace quintet::overlay
