// SPDX-License-Identifier: Apache-2.0
#include "scene/defaults/auto_camera.h"

#include <algorithm>
#include <array>

#include "base/error.h"

namespace quintet::scene {
namespace {

using glm::dmat3;
using glm::dvec2;
using glm::dvec3;

constexpr double kAzimuth = 30.0, kElevation = 20.0, kVerticalFov = 40.0;  // degrees
constexpr double kMargin = 1.04;

struct Box {
  dvec3 center{0.0};
  dvec3 half{1.0};
};

// Replaces empty bounds by [-1,1]³, and bounds without extent by a cube that is small relative to its distance from the
// origin, but above the resolution of floats there.
Box usableBox(const Bounds3& bounds) {
  if (bounds.empty() || !isFinite(bounds.min) || !isFinite(bounds.max)) return {};
  const dvec3 low(bounds.min), high(bounds.max);
  Box box{0.5 * (low + high), 0.5 * (high - low)};
  const double largest = std::max({box.half.x, box.half.y, box.half.z});
  const double away = glm::length(box.center);
  if (largest <= 1e-6 * away || largest < 1e-30) box.half = dvec3(away > 0.0 ? 1e-2 * away : 1.0);
  return box;
}

// `up`, or a fixed axis if the view is along it. Both vectors are unit.
vec3 uprightFor(const vec3& direction, const vec3& up) {
  if (glm::length(glm::cross(direction, up)) >= 1e-5f) return up;
  return std::abs(up.z) < 0.9f ? vec3(0, 0, -1) : vec3(1, 0, 0);
}

dmat3 viewAxes() {  // columns: right, up, backwards
  const double azimuth = glm::radians(kAzimuth), elevation = glm::radians(kElevation);
  const dvec3 back(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                   std::cos(azimuth) * std::cos(elevation));
  const dvec3 right = glm::normalize(glm::cross(dvec3(0, 1, 0), back));
  return {right, glm::cross(back, right), back};
}

using Corners = std::array<dvec3, 8>;  // in the camera's axes, relative to the center of the box

Corners cornersOf(const Box& box, const dmat3& axes) {
  Corners corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const dvec3 sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    corners[i] = glm::transpose(axes) * (sign * box.half);
  }
  return corners;
}

// Coordinate of the eye on one axis, at depth `z`, that centers the projections of the corners. The sum of the
// outermost projections decreases with the coordinate, so bisection finds its zero.
double centeredCoordinate(const Corners& corners, std::size_t axis, double z) {
  const auto [low, high] = std::ranges::minmax(corners, {}, [axis](const dvec3& c) { return c[axis]; });
  double left = low[axis], right = high[axis];
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (left + right);
    double smallest = std::numeric_limits<double>::infinity(), largest = -smallest;
    for (const dvec3& c : corners) {
      const double projected = (c[axis] - middle) / (z - c.z);
      smallest = std::min(smallest, projected), largest = std::max(largest, projected);
    }
    (smallest + largest > 0.0 ? left : right) = middle;
  }
  return 0.5 * (left + right);
}

// Position of the eye (in the same axes) from which the corners fill the frustum |x|, |y| <= slope · depth: as near as
// the tighter axis permits, centered on both.
dvec3 placeEye(const Corners& corners, const dvec2& slope) {
  double z = 0.0;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    // The two frustum planes of this axis that touch the corners intersect at the nearest possible eye.
    double right = -std::numeric_limits<double>::infinity(), left = right;
    for (const dvec3& c : corners) {
      right = std::max(right, c[axis] + slope[axis] * c.z);
      left = std::max(left, -c[axis] + slope[axis] * c.z);
    }
    z = std::max(z, 0.5 * (right + left) / slope[axis]);
  }
  return {centeredCoordinate(corners, 0, z), centeredCoordinate(corners, 1, z), z};
}

}  // namespace

Camera frameScene(const Bounds3& bounds, float aspect) {
  if (!std::isfinite(aspect) || aspect <= 0.0f) aspect = 1.0f;
  const Box box = usableBox(bounds);
  const dmat3 axes = viewAxes();
  const double slope = std::tan(glm::radians(kVerticalFov / 2.0)) / kMargin;
  const dvec3 eye = placeEye(cornersOf(box, axes), slope * dvec2(aspect, 1.0));

  Camera camera;
  camera.name = "automatic";
  camera.verticalFov = static_cast<float>(glm::radians(kVerticalFov));
  const dvec3 limit(std::numeric_limits<float>::max());
  const vec3 position(glm::clamp(box.center + axes * eye, -limit, limit));
  camera.worldFromCamera =
      mat4(vec4(vec3(axes[0]), 0.0f), vec4(vec3(axes[1]), 0.0f), vec4(vec3(axes[2]), 0.0f), vec4(position, 1.0f));
  camera.focusDistance = static_cast<float>(std::min(eye.z, limit.x));
  return camera;
}

Camera lookAtCamera(const vec3& eye, const vec3& target, const vec3& up, float verticalFov, float apertureRadius) {
  const vec3 toTarget = target - eye;
  if (!(glm::length(toTarget) > 0.0f)) throw UsageError("the camera position is also the point that it looks at");
  if (!(glm::length(up) > 0.0f)) throw UsageError("the camera's up vector is zero");
  const vec3 upright = uprightFor(glm::normalize(toTarget), glm::normalize(up));
  Camera camera;
  camera.worldFromCamera = glm::inverse(glm::lookAtRH(eye, target, upright));
  camera.focusDistance = glm::length(toTarget);
  camera.verticalFov = verticalFov;
  camera.apertureRadius = apertureRadius;
  return camera;
}

mat4 lookingFrame(const vec3& eye, const vec3& direction, const vec3& up) {
  mat4 frame = glm::transpose(glm::lookAtRH(vec3(0.0f), direction, uprightFor(direction, up)));
  frame[3] = vec4(eye, 1.0f);
  return frame;
}

}  // namespace quintet::scene
