// SPDX-License-Identifier: Apache-2.0
#include "overlay/ray_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "overlay/camera_projection.h"

namespace quintet::overlay {
namespace {

using job::ExplainedEvent;

// Colors of Okabe and Ito (2008, "Color Universal Design"), which people with color vision deficiencies can distinguish,
// with white for camera rays. Bytes R, G, B, A in memory order.
constexpr std::uint32_t kWhite = 0xFFFFFFFF;
constexpr std::uint32_t kSkyBlue = 0xFFE9B456;
constexpr std::uint32_t kYellow = 0xFF42E4F0;
constexpr std::uint32_t kVermilion = 0xFF005ED5;
constexpr std::uint32_t kPurple = 0xFFC8A0E0;  // lighter than the original, for thin lines
constexpr std::uint32_t kOutline = 0xB0000000;
constexpr std::uint32_t kSelectedOutline = 0xFFFFFFFF;
constexpr std::uint32_t kSelectedWhiteOutline = 0xFF000000;

constexpr float kEndlessExtent = 0.5f;    // length of a ray without an end, as a fraction of the extent
constexpr float kLongestExtent = 8.0f;    // longer rays are drawn as if they had no end
constexpr float kLeastSceneSize = 0.02f;  // of the scene's size: extents are at least this
constexpr float kNear = 1e-4f;            // of the extent: nearer points are not projected
constexpr float kGuard = 2.0f;            // lines are cut at this many image sizes around the image
constexpr float kRelativeBias = 2e-3f;    // of the depth
constexpr float kFaint = 0.35f;           // opacity of rays that are not selected
constexpr float kPixelRadius = 1.5f;      // film positions of a sample are at most this far from its pixel's center
constexpr float kRounding = 2.5e-7f;      // of a position in world space, as a fraction of its largest coordinate

// At scale 1, pixels.
constexpr float kPathWidth = 2.4f, kShadowWidth = 1.5f, kNormalWidth = 1.5f, kSelectedWidth = 4.0f;
constexpr float kMarker = 7.0f, kSelectedMarker = 10.0f;
constexpr float kCross = 4.5f;  // half of the diagonal
constexpr float kNormalLength = 26.0f;
constexpr float kArrow = 8.0f;  // length of the sides
constexpr float kLeastArrowLine = 60.0f;
constexpr float kDash = 5.0f;

std::uint32_t colorOf(OverlayRayKind kind) {
  switch (kind) {
    case OverlayRayKind::camera: return kWhite;
    case OverlayRayKind::indirect: return kSkyBlue;
    case OverlayRayKind::visible: return kYellow;
    case OverlayRayKind::occluded: return kVermilion;
  }
  return kWhite;
}

bool isShadow(OverlayRayKind kind) { return kind == OverlayRayKind::visible || kind == OverlayRayKind::occluded; }

// ---- From events to rays

const ExplainedEvent* hitOf(const ExplainedEvent& ray) {
  const auto found = std::ranges::find_if(
      ray.children, [](const ExplainedEvent& e) { return e.type == "closest-hit" || e.type == "hit"; });
  return found == ray.children.end() ? nullptr : &*found;
}

std::optional<vec3> unitVector(const ExplainedEvent& event, std::string_view field) {
  const vec3 value = event.vector(field);
  const float length = glm::length(value);
  if (!(length > 0.0f) || !std::isfinite(length)) return std::nullopt;
  return value / length;
}

// Rays that only find out whether something is hit.
bool isShadowRay(const ExplainedEvent& ray) {
  return ray.text("rayType") == "shadow" || ray.text("flags").find("TerminateOnFirstHit") != std::string::npos;
}

bool transmits(const ExplainedEvent& ray) {
  const vec3 transmittance = ray.vector("transmittance");
  return transmittance.x > 0.0f || transmittance.y > 0.0f || transmittance.z > 0.0f;
}

struct TracedRay {
  OverlayRay ray;
  vec3 direction{0.0f};  // as the program stated it
  float t = 0;           // of the hit, else the end of the interval
};

// Nothing for rays that cannot be drawn.
std::optional<TracedRay> tracedRay(const ExplainedEvent& event, std::size_t index, const std::optional<vec3>& eye) {
  const std::string result = event.text("result");
  TracedRay traced{{}, event.vector("direction"), event.number("tmax")};
  OverlayRay& ray = traced.ray;
  ray.index = index;
  ray.from = event.vector("origin");
  if (result == "not traced" || !isFinite(ray.from) || !isFinite(traced.direction) ||
      !(glm::length(traced.direction) > 0.0f))
    return std::nullopt;
  const ExplainedEvent* hit = result == "hit" ? hitOf(event) : nullptr;
  if (hit) {
    ray.hit = true;
    traced.t = hit->number("t");
    ray.normal = unitVector(*hit, "shadingNormal");
  }
  if (isShadowRay(event))
    ray.kind = hit && !transmits(event) ? OverlayRayKind::occluded : OverlayRayKind::visible;
  else
    ray.kind = !eye || *eye == ray.from ? OverlayRayKind::camera : OverlayRayKind::indirect;
  return traced;
}

std::vector<TracedRay> tracedRays(const job::PixelExplanation& explanation) {
  std::vector<TracedRay> rays;
  std::optional<vec3> eye;
  std::size_t index = 0;
  std::optional<std::size_t> surface;  // the ray whose hit the program shades
  job::forEachEvent(explanation.events, [&](const ExplainedEvent& event, int) {
    if (event.type == "ray") {
      const std::optional<TracedRay> traced = tracedRay(event, index++, eye);
      if (!traced) return;
      if (!eye) eye = traced->ray.from;
      rays.push_back(*traced);
      if (!isShadow(traced->ray.kind)) surface = rays.size() - 1;
    } else if (surface && rays[*surface].ray.hit && (event.type == "surface" || event.type == "shading")) {
      const auto normal = unitVector(event, event.type == "surface" ? "shadingNormal" : "normal");
      if (normal) rays[*surface].ray.normal = normal;
    }
  });
  return rays;
}

// ---- From rays to lines

// A line in pixels of the screen, cut to the part near the image.
struct ScreenLine {
  vec2 a{0.0f}, b{0.0f};
  float depthA = 0, depthB = 0;  // reversed
  float endA = 0, endB = 1;      // as fractions of the line in the image before the cut
};

class Screen {
 public:
  Screen(const OverlayView& view, float extent)
      : projection_(view.camera, view.placement.size), placement_(view.placement), near_(kNear * extent) {}

  const CameraProjection& projection() const { return projection_; }

  // `guard`: the line is cut at this many image sizes around the image.
  std::optional<ScreenLine> line(const vec3& from, const vec3& to, float guard = kGuard) const {
    vec3 a = projection_.toCamera(from), b = projection_.toCamera(to);
    if (!clipBehind(a, b)) return std::nullopt;
    const vec2 pixelA = projection_.toImage(a), pixelB = projection_.toImage(b);
    return cut({pixelA, pixelB, projection_.reversedDepth(-a.z), projection_.reversedDepth(-b.z)}, guard);
  }

  struct Point {
    vec2 at;
    float depth;  // reversed
  };
  // Nothing behind the camera and far from the image.
  std::optional<Point> point(const vec3& world) const {
    const vec3 p = projection_.toCamera(world);
    if (!projection_.orthographic() && p.z > -near_) return std::nullopt;
    const vec2 pixel = projection_.toImage(p), fraction = pixel / vec2(placement_.size);
    if (!(fraction.x >= -kGuard && fraction.y >= -kGuard && fraction.x <= 1.0f + kGuard && fraction.y <= 1.0f + kGuard))
      return std::nullopt;
    return Point{toScreen(pixel), projection_.reversedDepth(-p.z)};
  }
  // Meters that have this length on the screen, at the depth of a point.
  float worldLength(const vec3& world, float pixels) const {
    return projection_.pixelSize(-projection_.toCamera(world).z) * pixels / placement_.scale;
  }

 private:
  vec2 toScreen(vec2 pixel) const { return placement_.origin + placement_.scale * pixel; }

  // Moves an end behind the camera to the near plane; returns false if both are behind.
  bool clipBehind(vec3& a, vec3& b) const {
    if (projection_.orthographic()) return true;
    if (a.z > -near_ && b.z > -near_) return false;
    if (a.z > -near_) a = glm::mix(a, b, (-near_ - a.z) / (b.z - a.z));
    if (b.z > -near_) b = glm::mix(b, a, (-near_ - b.z) / (a.z - b.z));
    return true;
  }

  // Liang and Barsky (1984). `line` is in pixels of the image; the result is on the screen.
  std::optional<ScreenLine> cut(const ScreenLine& line, float guard) const {
    const vec2 size(placement_.size), least = -guard * size, most = (1.0f + guard) * size, step = line.b - line.a;
    float first = 0.0f, last = 1.0f;
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
      if (step[axis] == 0.0f) {
        if (line.a[axis] < least[axis] || line.a[axis] > most[axis]) return std::nullopt;
        continue;
      }
      const float t0 = (least[axis] - line.a[axis]) / step[axis], t1 = (most[axis] - line.a[axis]) / step[axis];
      first = std::max(first, std::min(t0, t1));
      last = std::min(last, std::max(t0, t1));
    }
    if (!(first <= last)) return std::nullopt;
    const auto depthAt = [&](float t) { return glm::mix(line.depthA, line.depthB, t); };
    return ScreenLine{
        toScreen(line.a + first * step), toScreen(line.a + last * step), depthAt(first), depthAt(last), first, last};
  }

  CameraProjection projection_;
  ImagePlacement placement_;
  float near_;  // meters
};

// Whether the view looks along the ray, through the lens in which it starts.
bool startsInLens(const OverlayRay& ray, const OverlayView& view, const Screen& screen) {
  if (ray.kind != OverlayRayKind::camera) return false;
  const vec3 origin = screen.projection().toCamera(ray.from);
  if (view.camera.orthographic) {
    const vec3 end = screen.projection().toCamera(ray.to);
    return glm::length(vec2(end - origin)) <= 1e-3f * glm::length(end - origin);
  }
  return glm::length(origin) <= 1.01f * view.camera.apertureRadius + 1e-4f * glm::length(ray.to - ray.from);
}

// Appends the lines of an overlay, the selected ray last.
class LineMaker {
 public:
  LineMaker(const RayOverlay& overlay, const OverlayView& view, const OverlayStyle& style)
      : overlay_(overlay), view_(view), style_(style), screen_(view, overlay.extent) {}

  std::vector<gpu::Line> make() {
    for (const bool selected : {false, true}) {
      for (const OverlayRay& ray : overlay_.rays)
        if (isSelected(ray) == selected) addLine(ray);
      for (const OverlayRay& ray : overlay_.rays)
        if (isSelected(ray) == selected) addMarkers(ray);
    }
    return std::move(lines_);
  }

 private:
  bool isSelected(const OverlayRay& ray) const { return style_.selected == ray.index; }

  gpu::Line styled(const OverlayRay& ray, std::uint32_t color, float width) const {
    gpu::Line line;
    const bool selected = isSelected(ray);
    line.color = color;
    line.outlineColor = !selected ? kOutline : color == kWhite ? kSelectedWhiteOutline : kSelectedOutline;
    line.width = style_.scale * width;
    line.outline = style_.scale * (selected ? 1.5f : 1.0f);
    line.opacityA = line.opacityB = style_.selected && !selected ? kFaint : 1.0f;
    return line;
  }

  void add(gpu::Line line, vec2 a, vec2 b, float depthA, float depthB) {
    line.ax = a.x, line.ay = a.y, line.bx = b.x, line.by = b.y;
    line.depthA = depthA, line.depthB = depthB;
    lines_.push_back(line);
  }

  void addLine(const OverlayRay& ray) {
    if (startsInLens(ray, view_, screen_)) return;
    const std::optional<ScreenLine> at = screen_.line(ray.from, ray.to);
    if (!at) return;
    const float width = isSelected(ray) ? kSelectedWidth : isShadow(ray.kind) ? kShadowWidth : kPathWidth;
    gpu::Line line = styled(ray, colorOf(ray.kind), width);
    gpu::Line fading = line;
    if (ray.endless) {
      fading.opacityA *= 1.0f - at->endA;
      fading.opacityB *= 1.0f - at->endB;
    }
    add(fading, at->a, at->b, at->depthA, at->depthB);
    if (isShadow(ray.kind)) return;
    if (const std::optional<ScreenLine> inImage = screen_.line(ray.from, ray.to, 0.0f)) addArrow(line, *inImage);
  }

  // In the middle of the visible part, in the direction of the ray.
  void addArrow(gpu::Line line, const ScreenLine& at) {
    const vec2 step = at.b - at.a;
    const float length = glm::length(step);
    if (length < kLeastArrowLine * style_.scale) return;
    const vec2 along = step / length, across(-along.y, along.x);
    const vec2 tip = at.a + 0.5f * step;
    const float depth = glm::mix(at.depthA, at.depthB, 0.5f);
    const float side = style_.scale * kArrow;
    for (const float sign : {-1.0f, 1.0f})
      add(line, tip - side * (0.85f * along + sign * 0.5f * across), tip, depth, depth);
  }

  void addMarkers(const OverlayRay& ray) {
    if (!ray.hit) return;
    const std::optional<Screen::Point> at = screen_.point(ray.to);
    if (!at) return;
    if (ray.kind == OverlayRayKind::occluded) {
      const vec2 diagonal = style_.scale * kCross * vec2(0.7071f, 0.7071f);
      const gpu::Line line = styled(ray, colorOf(ray.kind), isSelected(ray) ? kPathWidth : 1.2f * kShadowWidth);
      for (const vec2 half : {diagonal, diagonal * vec2(1.0f, -1.0f)})
        add(line, at->at - half, at->at + half, at->depth, at->depth);
      return;
    }
    if (isShadow(ray.kind)) return;
    if (style_.normals && ray.normal) addNormal(ray);
    add(styled(ray, colorOf(ray.kind), isSelected(ray) ? kSelectedMarker : kMarker), at->at, at->at, at->depth,
        at->depth);
  }

  void addNormal(const OverlayRay& ray) {
    const float length = screen_.worldLength(ray.to, style_.scale * kNormalLength);
    const std::optional<ScreenLine> at = screen_.line(ray.to, ray.to + length * *ray.normal);
    if (at) add(styled(ray, kPurple, kNormalWidth), at->a, at->b, at->depthA, at->depthB);
  }

  const RayOverlay& overlay_;
  const OverlayView& view_;
  const OverlayStyle& style_;
  const Screen screen_;
  std::vector<gpu::Line> lines_;
};

float distanceToLine(vec2 point, vec2 a, vec2 b) {
  const vec2 step = b - a;
  const float squared = glm::dot(step, step);
  const float t = squared > 0.0f ? std::clamp(glm::dot(point - a, step) / squared, 0.0f, 1.0f) : 0.0f;
  return glm::length(point - (a + t * step));
}

}  // namespace

RayOverlay rayOverlay(const job::PixelExplanation& explanation, float sceneSize) {
  const std::vector<TracedRay> traced = tracedRays(explanation);
  Bounds3 bounds;
  for (const TracedRay& t : traced) {
    bounds.extend(t.ray.from);
    if (const vec3 end = t.ray.from + t.t * t.direction; t.ray.hit && isFinite(end)) bounds.extend(end);
  }
  RayOverlay overlay;
  const float diagonal = bounds.empty() ? 0.0f : glm::length(bounds.extent());
  overlay.extent = diagonal > 0.0f ? std::max(diagonal, kLeastSceneSize * sceneSize) : sceneSize;
  for (const TracedRay& t : traced) {
    OverlayRay ray = t.ray;
    const float length = glm::length(t.direction);
    ray.endless = !ray.hit && !(t.t * length <= kLongestExtent * overlay.extent);
    ray.to = ray.from + (ray.endless ? kEndlessExtent * overlay.extent / length : t.t) * t.direction;
    if (isFinite(ray.to)) overlay.rays.push_back(ray);
  }
  return overlay;
}

bool usesCamera(const job::PixelExplanation& explanation, const scene::Camera& camera) {
  const std::vector<TracedRay> rays = tracedRays(explanation);
  if (rays.empty() || rays.front().ray.kind != OverlayRayKind::camera) return false;
  const CameraProjection projection(camera, glm::max(explanation.size, uvec2(1)));
  // Relative to the camera, so that large coordinates cancel without an error.
  const mat3 cameraFromWorld(projection.cameraFromWorld());
  const vec3 &from = rays.front().ray.from, eye(camera.worldFromCamera[3]);
  vec3 origin = cameraFromWorld * (from - eye);
  const vec3 direction = glm::normalize(cameraFromWorld * rays.front().direction);
  float rounding = kRounding * std::max({std::abs(from.x), std::abs(from.y), std::abs(from.z)});
  const float size = camera.orthographic ? 1.0f : camera.focusDistance;
  vec3 focus = origin;
  if (camera.orthographic) {
    if (!(glm::length(vec2(direction)) <= 1e-3f && direction.z < 0.0f)) return false;
  } else {
    const float radius = 1.01f * camera.apertureRadius + 1e-3f * size + rounding;
    if (!(glm::length(origin) <= radius && direction.z < 0.0f)) return false;
    if (camera.apertureRadius == 0.0f) {  // the origin is the eye, so only the direction counts
      origin = vec3(0.0f);
      rounding = 0.0f;
    }
    focus = origin + (-size - origin.z) / direction.z * direction;
  }
  const vec2 offset = projection.toImage(focus) - (vec2(explanation.pixel) + 0.5f);
  const float radius = kPixelRadius + rounding / projection.pixelSize(size);
  return std::abs(offset.x) <= radius && std::abs(offset.y) <= radius;
}

gpu::LineList overlayLines(const RayOverlay& overlay, const OverlayView& view, const OverlayStyle& style,
                           const job::DepthMap* depth) {
  gpu::LineList list;
  list.lines = LineMaker(overlay, view, style).make();
  list.depthX = view.placement.origin.x;
  list.depthY = view.placement.origin.y;
  if (depth)
    list.depthScale =
        view.placement.scale * static_cast<float>(view.placement.size.x) / static_cast<float>(depth->size.x);
  if (view.camera.orthographic)
    list.bias = kRelativeBias * overlay.extent;
  else
    list.relativeBias = kRelativeBias;
  list.dash = style.scale * kDash;
  return list;
}

std::optional<std::size_t> rayAt(const RayOverlay& overlay, const OverlayView& view, vec2 position, float distance) {
  const Screen screen(view, overlay.extent);
  std::optional<std::size_t> nearest;
  const auto offer = [&](const OverlayRay& ray, float d) {
    if (!(d <= distance)) return;
    distance = d;
    nearest = ray.index;
  };
  for (const OverlayRay& ray : overlay.rays) {
    if (startsInLens(ray, view, screen)) {
      if (const auto end = ray.hit ? screen.point(ray.to) : std::nullopt) offer(ray, glm::length(position - end->at));
    } else if (const std::optional<ScreenLine> line = screen.line(ray.from, ray.to)) {
      offer(ray, distanceToLine(position, line->a, line->b));
    }
  }
  return nearest;
}

std::shared_ptr<const std::vector<float>> reversedDepths(const job::DepthMap& map) {
  auto depths = std::make_shared<std::vector<float>>(map.depths.size());
  const bool orthographic = map.camera.orthographic;
  std::ranges::transform(map.depths, depths->begin(), [&](float depth) {
    if (orthographic) return depth != 0.0f ? -depth : std::numeric_limits<float>::lowest();
    return depth > 0.0f ? 1.0f / depth : 0.0f;
  });
  return depths;
}

std::vector<RayLegendEntry> rayLegend(const RayOverlay& overlay) {
  constexpr std::array<std::pair<OverlayRayKind, const char*>, 4> kTexts{{
      {OverlayRayKind::camera, "Camera ray"},
      {OverlayRayKind::indirect, "Indirect ray"},
      {OverlayRayKind::visible, "Shadow ray, not blocked"},
      {OverlayRayKind::occluded, "Shadow ray, blocked"},
  }};
  std::vector<RayLegendEntry> entries;
  if (overlay.rays.empty()) return entries;
  for (const auto& [kind, text] : kTexts)
    if (std::ranges::find(overlay.rays, kind, &OverlayRay::kind) != overlay.rays.end())
      entries.push_back({text, colorOf(kind)});
  const auto hasNormal = [](const OverlayRay& ray) { return ray.normal && !isShadow(ray.kind); };
  if (std::ranges::any_of(overlay.rays, hasNormal)) entries.push_back({"Shading normal", kPurple});
  entries.push_back({"Behind a surface", kSkyBlue, true});
  return entries;
}

}  // namespace quintet::overlay
