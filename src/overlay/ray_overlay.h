// SPDX-License-Identifier: Apache-2.0
// The rays of an explained pixel as lines over an image of the scene: what is drawn, in which colors, and which ray is
// at a position of the image. gpu::LineRenderer draws the lines.
#ifndef QUINTET_OVERLAY_RAY_OVERLAY_H
#define QUINTET_OVERLAY_RAY_OVERLAY_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "gpu/present/line_list.h"
#include "job/depth_map.h"
#include "job/pixel_explanation.h"
#include "overlay/image_placement.h"
#include "scene/model/scene.h"

namespace quintet::overlay {

enum class OverlayRayKind {
  camera,    // the first ray, and those with the same origin
  indirect,  // from a surface, to find the next one
  visible,   // shadow ray that nothing blocks
  occluded,  // shadow ray that ends at a surface
};

// World space, meters.
struct OverlayRay {
  OverlayRayKind kind = OverlayRayKind::camera;
  std::size_t index = 0;  // among the events `ray`, in the order of job::forEachEvent(), from 0
  vec3 from{0.0f}, to{0.0f};
  bool endless = false;        // the ray has no end, or a distant one: `to` is a point on the way
  bool hit = false;            // `to` is a surface
  std::optional<vec3> normal;  // shading normal of the surface, unit
};

struct RayOverlay {
  std::vector<OverlayRay> rays;  // in the order of the traces
  float extent = 1;              // meters: about the diagonal of the bounds of all origins and hits
};

// The rays that were traced. `sceneSize`: diagonal of the scene, meters, > 0: the extent for rays without surfaces, and
// 50 times the least extent of others. Rays without an end have half of the overlay's extent.
RayOverlay rayOverlay(const job::PixelExplanation& explanation, float sceneSize);

// Whether the first ray of the explanation is one of this camera through the explained pixel. If not, the program has a
// camera of its own, and lines would not fit its image. `camera`: as it was when the pixel was explained.
bool usesCamera(const job::PixelExplanation& explanation, const scene::Camera& camera);

struct OverlayView {
  scene::Camera camera;
  ImagePlacement placement;  // size > 0
};

struct OverlayStyle {
  float scale = 1;                      // factor of widths and markers
  std::optional<std::size_t> selected;  // OverlayRay::index; the other rays are then faint
  bool normals = true;
};

// Lines in pixels of the screen. A camera ray that starts in the lens of the view's camera is only drawn as the marker
// of its hit, because it is seen along its direction. `depth`: of the view, for LineList::depthScale; null if there is
// none.
gpu::LineList overlayLines(const RayOverlay& overlay, const OverlayView& view, const OverlayStyle& style,
                           const job::DepthMap* depth);

// The index of the nearest ray that is at most `distance` screen pixels away from `position`; nothing if there is none.
std::optional<std::size_t> rayAt(const RayOverlay& overlay, const OverlayView& view, vec2 position, float distance);

// Depths for gpu::LineRenderer::setDepth().
std::shared_ptr<const std::vector<float>> reversedDepths(const job::DepthMap& map);

// What the colors mean.
struct RayLegendEntry {
  std::string text;
  std::uint32_t color = 0;  // gpu::Line::color
  bool hidden = false;      // drawn as parts behind a surface are
};
std::vector<RayLegendEntry> rayLegend(const RayOverlay& overlay);  // of what the overlay contains; empty without rays

}  // namespace quintet::overlay
#endif
