// SPDX-License-Identifier: Apache-2.0
#include "overlay/ray_overlay.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace quintet::overlay {
namespace {

using job::ExplainedEvent;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr uvec2 kSize{200, 100};

job::EventValue floats(const vec3& v) { return std::vector<float>{v.x, v.y, v.z}; }

// `t`: of the hit; the ray misses if it is 0.
ExplainedEvent ray(const char* type, const vec3& origin, const vec3& direction, float tmax, float t) {
  ExplainedEvent event{"ray",
                       {{"rayType", std::string(type)},
                        {"flags", std::string()},
                        {"origin", floats(origin)},
                        {"direction", floats(direction)},
                        {"tmax", tmax},
                        {"result", std::string(t > 0 ? "hit" : "miss")}},
                       {}};
  if (t > 0) event.children.push_back({"closest-hit", {{"t", t}, {"shadingNormal", floats({0, 2, 0})}}, {}});
  return event;
}

// A camera at (0, 0, 5) that looks along -z; the first ray goes through the pixel (100, 50).
scene::Camera camera() {
  scene::Camera result;
  result.verticalFov = glm::radians(90.0f);
  result.worldFromCamera[3] = {0, 0, 5, 1};
  return result;
}

// The same scene from the side, 10 m away.
scene::Camera sideCamera() {
  scene::Camera result;
  result.verticalFov = glm::radians(90.0f);
  result.worldFromCamera = glm::translate(mat4(1.0f), {10, 0, 0}) * glm::rotate(mat4(1.0f), kPi / 2, {0, 1, 0});
  return result;
}

// Camera ray to the origin, a blocked and an unblocked shadow ray, a skipped ray, and a bounce into the sky.
job::PixelExplanation path() {
  job::PixelExplanation e;
  e.size = kSize;
  e.pixel = {100, 50};
  const vec3 eye(0, 0, 5), through = glm::normalize(vec3(0.01f, -0.01f, -1.0f));
  ExplainedEvent skipped = ray("radiance", {0, 0, 0}, {0, 1, 0}, kInfinity, 0);
  skipped.set("result", std::string("not traced"));
  e.events = {ray("radiance", eye, through, kInfinity, 5.0f), ray("shadow", {0, 0, 0}, {0, 1, 0}, 4.0f, 0),
              ray("shadow", {0, 0, 0}, {0, 0, 1}, 4.0f, 1.5f), skipped,
              ray("radiance", {0, 0, 0}, {0, 2, 0}, kInfinity, 0)};
  return e;
}

OverlayView viewOf(const scene::Camera& camera, uvec2 size = kSize) {
  OverlayView view{camera, {}};
  view.placement.size = size;
  return view;
}

bool isFinite(const gpu::Line& line) {
  return std::isfinite(line.ax + line.ay + line.bx + line.by + line.depthA + line.depthB);
}

// Lines that are neither arrows nor markers: those of this color with a length of more than 20 pixels.
std::vector<gpu::Line> longLines(const gpu::LineList& list, std::uint32_t color) {
  std::vector<gpu::Line> result;
  for (const gpu::Line& line : list.lines)
    if (line.color == color && std::hypot(line.bx - line.ax, line.by - line.ay) > 20.0f) result.push_back(line);
  return result;
}

std::uint32_t colorOf(const std::vector<RayLegendEntry>& legend, const std::string& text) {
  const auto found = std::ranges::find(legend, text, &RayLegendEntry::text);
  return found == legend.end() ? 0 : found->color;
}

TEST(RayOverlay, ClassifiesRays) {
  const RayOverlay overlay = rayOverlay(path(), 100.0f);
  ASSERT_EQ(overlay.rays.size(), 4u) << "a ray that was not traced is not drawn";
  EXPECT_EQ(overlay.rays[0].kind, OverlayRayKind::camera);
  EXPECT_EQ(overlay.rays[1].kind, OverlayRayKind::visible);
  EXPECT_EQ(overlay.rays[2].kind, OverlayRayKind::occluded);
  EXPECT_EQ(overlay.rays[3].kind, OverlayRayKind::indirect);
  EXPECT_EQ(overlay.rays[2].index, 2u);
  EXPECT_EQ(overlay.rays[3].index, 4u) << "indices count all rays";
  EXPECT_NEAR(glm::length(overlay.rays[0].to), 0.0f, 0.1f);
  EXPECT_TRUE(overlay.rays[0].hit);
  ASSERT_TRUE(overlay.rays[0].normal);
  EXPECT_FLOAT_EQ(overlay.rays[0].normal->y, 1.0f);
  EXPECT_EQ(overlay.rays[1].to, vec3(0, 4, 0)) << "to the light";
  EXPECT_FALSE(overlay.rays[1].endless);
  EXPECT_EQ(overlay.rays[2].to, vec3(0, 0, 1.5f)) << "to the surface that blocks it";
}

TEST(RayOverlay, RaysOfUserProgramsAreShadowRaysByTheirFlags) {
  job::PixelExplanation e = path();
  e.events[1].set("rayType", std::string("occlusion"));
  e.events[1].set("flags", std::string("Opaque TerminateOnFirstHit"));
  EXPECT_EQ(rayOverlay(e, 1.0f).rays[1].kind, OverlayRayKind::visible);
  e.events[2].set("transmittance", floats({0, 0.5f, 0}));
  EXPECT_EQ(rayOverlay(e, 1.0f).rays[2].kind, OverlayRayKind::visible) << "some light passes";
}

TEST(RayOverlay, FindsNestedRays) {
  job::PixelExplanation e = path();
  e.events[0].children[0].children.push_back(ray("radiance", {0, 0, 0}, {1, 0, 0}, kInfinity, 2.0f));
  const RayOverlay overlay = rayOverlay(e, 1.0f);
  ASSERT_EQ(overlay.rays.size(), 5u);
  EXPECT_EQ(overlay.rays[1].to, vec3(2, 0, 0));
  EXPECT_EQ(overlay.rays[1].index, 1u);
  EXPECT_EQ(overlay.rays[1].kind, OverlayRayKind::indirect);
}

TEST(RayOverlay, RaysWithoutAnEndGetALengthThatFits) {
  job::PixelExplanation e = path();
  e.events[1].set("tmax", 1e10f);
  const RayOverlay overlay = rayOverlay(e, 100.0f);
  EXPECT_NEAR(overlay.extent, 5.0f, 0.1f);
  for (const std::size_t i : {std::size_t{1}, std::size_t{3}}) {
    EXPECT_TRUE(overlay.rays[i].endless);
    EXPECT_NEAR(glm::length(overlay.rays[i].to - overlay.rays[i].from), 0.5f * overlay.extent, 1e-4f);
  }
  // Without a surface, the scene decides.
  job::PixelExplanation sky;
  sky.events = {ray("radiance", {1, 2, 3}, {0, 0, -1}, kInfinity, 0)};
  EXPECT_EQ(rayOverlay(sky, 100.0f).extent, 100.0f);
  EXPECT_EQ(rayOverlay(sky, 100.0f).rays.at(0).to, vec3(1, 2, -47));
  EXPECT_TRUE(rayOverlay({}, 1.0f).rays.empty());
}

TEST(RayOverlay, TheExtentIsNotMuchLessThanTheScene) {
  job::PixelExplanation e;
  e.events = {ray("radiance", {0, 0, 0}, {0, 0, -1}, kInfinity, 1.0f)};
  EXPECT_FLOAT_EQ(rayOverlay(e, 10.0f).extent, 1.0f);
  EXPECT_FLOAT_EQ(rayOverlay(e, 100.0f).extent, 2.0f);
}

TEST(RayOverlay, TakesTheNormalThatTheProgramShades) {
  job::PixelExplanation e = path();
  e.events.insert(e.events.begin() + 1, {{"surface", {{"shadingNormal", floats({1, 0, 0})}}, {}},
                                         {"shading", {{"normal", floats({0, 0, 1})}}, {}}});
  EXPECT_EQ(*rayOverlay(e, 1.0f).rays[0].normal, vec3(0, 0, 1));
}

TEST(RayOverlay, SkipsValuesThatAreNotFinite) {
  job::PixelExplanation e = path();
  e.events[0].set("origin", floats({std::nanf(""), 0, 0}));
  e.events[1].set("direction", floats({0, 0, 0}));
  e.events[2].children[0].set("t", kInfinity);
  const RayOverlay overlay = rayOverlay(e, 1.0f);
  ASSERT_EQ(overlay.rays.size(), 1u);
  EXPECT_EQ(overlay.rays[0].index, 4u);
}

TEST(RayOverlay, RecognizesTheCamera) {
  job::PixelExplanation e = path();
  EXPECT_TRUE(usesCamera(e, camera()));
  EXPECT_FALSE(usesCamera(e, sideCamera()));
  EXPECT_FALSE(usesCamera({}, camera()));
  e.pixel = {104, 50};
  EXPECT_FALSE(usesCamera(e, camera())) << "the ray of a different pixel";
  e.pixel = {100, 50};

  scene::Camera lens = camera();
  lens.apertureRadius = 0.5f;
  lens.focusDistance = 2.0f;
  const vec3 focus(0.01f, -0.01f, 3.0f), origin(0.3f, 0.2f, 5.0f);
  e.events[0] = ray("radiance", origin, glm::normalize(focus - origin), kInfinity, 5.0f);
  EXPECT_TRUE(usesCamera(e, lens));
  EXPECT_FALSE(usesCamera(e, camera())) << "a pinhole";

  scene::Camera box = camera();
  box.orthographic = true;
  e.events[0] = ray("radiance", {0.01f, -0.01f, 5.0f}, {0, 0, -1}, kInfinity, 5.0f);
  EXPECT_TRUE(usesCamera(e, box));
  e.events[0] = ray("radiance", {0.3f, -0.01f, 5.0f}, {0, 0, -1}, kInfinity, 5.0f);
  EXPECT_FALSE(usesCamera(e, box));
}

TEST(RayOverlay, RecognizesTheCameraFarFromTheOrigin) {
  const vec3 offset(500000.0f, -500000.0f, 500000.0f);
  job::PixelExplanation e = path();
  scene::Camera far = camera();
  far.worldFromCamera[3] += vec4(offset, 0.0f);
  e.events[0].set("origin", floats(vec3(far.worldFromCamera[3])));
  EXPECT_TRUE(usesCamera(e, far));
  far.worldFromCamera = glm::rotate(far.worldFromCamera, 0.7f, glm::normalize(vec3(1, 2, 3)));
  EXPECT_FALSE(usesCamera(e, far)) << "it looks elsewhere";
  e.events[0].set("direction", floats(mat3(far.worldFromCamera) * e.events[0].vector("direction")));
  EXPECT_TRUE(usesCamera(e, far));
  e.pixel.x += 4;
  EXPECT_FALSE(usesCamera(e, far));
}

TEST(RayOverlay, DrawsProjectedLinesAndMarkers) {
  const RayOverlay overlay = rayOverlay(path(), 1.0f);
  const auto legend = rayLegend(overlay);
  const gpu::LineList list = overlayLines(overlay, viewOf(sideCamera()), {}, nullptr);
  // 10 m away, the image is 20 m high and 40 m wide. -z is to the right.
  const auto cameraRays = longLines(list, colorOf(legend, "Camera ray"));
  ASSERT_EQ(cameraRays.size(), 1u);
  EXPECT_NEAR(cameraRays[0].ax, 75.0f, 0.1f);
  EXPECT_NEAR(cameraRays[0].bx, 100.0f, 0.1f);
  EXPECT_NEAR(cameraRays[0].ay, 50.0f, 0.1f);
  EXPECT_NEAR(cameraRays[0].depthA, 0.1f, 1e-4f);
  EXPECT_EQ(cameraRays[0].opacityA, 1.0f);
  const gpu::LineList again = overlayLines(overlay, viewOf(sideCamera(), {800, 400}), {}, nullptr);
  const auto sky = longLines(again, colorOf(legend, "Indirect ray"));
  ASSERT_EQ(sky.size(), 1u);
  EXPECT_EQ(sky[0].opacityA, 1.0f);
  EXPECT_EQ(sky[0].opacityB, 0.0f) << "a ray without an end fades out";
  const auto isDisk = [](const gpu::Line& line) { return line.ax == line.bx && line.ay == line.by; };
  EXPECT_EQ(std::ranges::count_if(list.lines, isDisk), 1) << "the hit of the camera ray";
  EXPECT_TRUE(std::ranges::all_of(list.lines, isFinite));
}

TEST(RayOverlay, PlacesTheLinesOnTheScreen) {
  const RayOverlay overlay = rayOverlay(path(), 1.0f);
  OverlayView view = viewOf(sideCamera());
  const gpu::Line plain = overlayLines(overlay, view, {}, nullptr).lines.at(0);
  view.placement.origin = {30, 40};
  view.placement.scale = 3;
  job::DepthMap depth;
  depth.size = {100, 50};
  const gpu::LineList list = overlayLines(overlay, view, {}, &depth);
  EXPECT_NEAR(list.lines.at(0).ax, 30 + 3 * plain.ax, 1e-3f);
  EXPECT_NEAR(list.lines.at(0).by, 40 + 3 * plain.by, 1e-3f);
  EXPECT_EQ(list.depthX, 30.0f);
  EXPECT_EQ(list.depthScale, 6.0f) << "the depths have half of the resolution";
}

TEST(RayOverlay, ShowsTheCameraRayOfTheViewAsAPoint) {
  const RayOverlay overlay = rayOverlay(path(), 1.0f);
  const gpu::LineList list = overlayLines(overlay, viewOf(camera()), {}, nullptr);
  const std::uint32_t color = colorOf(rayLegend(overlay), "Camera ray");
  EXPECT_TRUE(longLines(list, color).empty());
  const auto marker = std::ranges::find(list.lines, color, &gpu::Line::color);
  ASSERT_NE(marker, list.lines.end());
  EXPECT_NEAR(marker->ax, 100.5f, 0.1f);
  EXPECT_EQ(rayAt(overlay, viewOf(camera()), {101, 51}, 4.0f), 0u);
}

TEST(RayOverlay, EmphasizesTheSelectedRay) {
  const RayOverlay overlay = rayOverlay(path(), 1.0f);
  OverlayStyle style;
  const gpu::LineList plain = overlayLines(overlay, viewOf(sideCamera(), {800, 400}), style, nullptr);
  style.selected = 4;
  const gpu::LineList list = overlayLines(overlay, viewOf(sideCamera(), {800, 400}), style, nullptr);
  ASSERT_EQ(list.lines.size(), plain.lines.size());
  const std::uint32_t color = colorOf(rayLegend(overlay), "Indirect ray");
  EXPECT_EQ(list.lines.back().color, color) << "drawn last";
  EXPECT_GT(longLines(list, color).at(0).width, longLines(plain, color).at(0).width);
  EXPECT_EQ(longLines(list, color).at(0).opacityA, 1.0f);
  for (const gpu::Line& line : list.lines) EXPECT_TRUE(line.color == color || line.opacityA < 0.5f);
}

TEST(RayOverlay, CutsLinesBehindTheCamera) {
  const RayOverlay overlay = rayOverlay(path(), 1.0f);
  scene::Camera inside = sideCamera();  // the camera ray begins before it and ends behind it
  inside.worldFromCamera[3] = {0.03f, 0, 3, 1};
  scene::Camera along = camera();
  along.worldFromCamera[3] = {0.02f, 0, 2, 1};  // the ray starts behind it
  scene::Camera away = along;
  away.worldFromCamera = glm::translate(mat4(1.0f), {0, 0, 6}) * glm::rotate(mat4(1.0f), kPi, {0, 1, 0});
  EXPECT_TRUE(overlayLines(overlay, viewOf(away), {}, nullptr).lines.empty()) << "everything is behind it";
  EXPECT_FALSE(rayAt(overlay, viewOf(away), {100, 50}, 1000.0f));
  for (const scene::Camera& camera : {inside, along}) {
    const gpu::LineList list = overlayLines(overlay, viewOf(camera), {}, nullptr);
    EXPECT_FALSE(list.lines.empty());
    for (const gpu::Line& line : list.lines) {
      EXPECT_TRUE(isFinite(line));
      EXPECT_GT(line.depthA, 0.0f);
      // Twice the size of the image around it.
      for (const float x : {line.ax, line.bx}) EXPECT_TRUE(x >= -401.0f && x <= 601.0f) << x;
      for (const float y : {line.ay, line.by}) EXPECT_TRUE(y >= -201.0f && y <= 301.0f) << y;
    }
  }
}

TEST(RayOverlay, FindsTheNearestRay) {
  const RayOverlay overlay = rayOverlay(path(), 1.0f);
  const OverlayView view = viewOf(sideCamera());
  EXPECT_EQ(rayAt(overlay, view, {80, 51}, 3.0f), 0u);
  EXPECT_EQ(rayAt(overlay, view, {95, 49.9f}, 3.0f), 2u) << "the blocked shadow ray is on the way of the camera ray";
  EXPECT_FALSE(rayAt(overlay, view, {80, 60}, 3.0f));
  EXPECT_EQ(rayAt(overlay, view, {80, 60}, 11.0f), 0u);
}

TEST(RayOverlay, ExplainsTheColorsThatAreDrawn) {
  std::vector<std::string> texts;
  for (const RayLegendEntry& entry : rayLegend(rayOverlay(path(), 1.0f))) texts.push_back(entry.text);
  EXPECT_EQ(texts, (std::vector<std::string>{"Camera ray", "Indirect ray", "Shadow ray, not blocked",
                                             "Shadow ray, blocked", "Shading normal", "Behind a surface"}));
  job::PixelExplanation sky;
  sky.events = {ray("radiance", {1, 2, 3}, {0, 0, -1}, kInfinity, 0)};
  EXPECT_EQ(rayLegend(rayOverlay(sky, 1.0f)).size(), 2u);
  EXPECT_TRUE(rayLegend({}).empty());
}

TEST(RayOverlay, ReversesDepths) {
  job::DepthMap map{{3, 1}, camera(), {2.0f, 0.0f, 0.5f}};
  EXPECT_EQ(*reversedDepths(map), (std::vector<float>{0.5f, 0.0f, 2.0f}));
  map.camera.orthographic = true;
  EXPECT_EQ(*reversedDepths(map), (std::vector<float>{-2.0f, std::numeric_limits<float>::lowest(), -0.5f}));
}

}  // namespace
}  // namespace quintet::overlay
