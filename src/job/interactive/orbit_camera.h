// SPDX-License-Identifier: Apache-2.0
// Navigation of a perspective camera around a point: each function returns the moved camera.
#ifndef QUINTET_JOB_INTERACTIVE_ORBIT_CAMERA_H
#define QUINTET_JOB_INTERACTIVE_ORBIT_CAMERA_H

#include "base/math.h"
#include "job/request.h"
#include "scene/model/scene.h"

namespace quintet::job::interactive {

struct OrbitCamera {
  vec3 center{0.0f};                 // world space: the point that the camera looks at
  float distance = 1.0f;             // from the center to the camera, meters, > 0
  quat worldFromCamera{1, 0, 0, 0};  // rotation; the camera looks along -z, y up
  float verticalFov = kPi / 4.0f;    // radians
  float apertureRadius = 0.0f;       // meters
  float focusDistance = 1.0f;        // meters

  vec3 eye() const;
  float depthOf(const vec3& point) const;  // along the optical axis, meters; positive in front of the camera
  CameraRequest request() const;           // the same camera as a request
};

// `center`: the point on the optical axis with the depth of this point; if that is behind the camera, the point in
// focus. Throws UsageError for an orthographic camera.
OrbitCamera orbitCamera(const scene::Camera& camera, const vec3& center);

// Orbits `pivot` by angles in degrees: `right` about the y axis of world space, so that the camera moves to the right,
// `up` about the horizontal axis of the image. The pivot keeps its pixel.
OrbitCamera orbit(OrbitCamera camera, float right, float up, const vec3& pivot);

// Moves the camera so that the center moves by this number of pixels (x right, y down) in an image of this size.
OrbitCamera pan(OrbitCamera camera, vec2 pixels, uvec2 size);

// Divides the distance by `factor` (> 0). What is at the center's depth in this pixel stays there (x right, y down).
OrbitCamera zoom(OrbitCamera camera, float factor, vec2 pixel, uvec2 size);

// Moves by meters along the camera's axes: right, up, forward. Then turns the camera in place by degrees: `yaw` to the
// left, about the y axis of world space, and `pitch` upward.
OrbitCamera fly(OrbitCamera camera, vec3 meters, float yaw, float pitch);

// Shows all of the bounds from the same direction. Empty bounds change nothing.
OrbitCamera frame(OrbitCamera camera, const Bounds3& bounds, uvec2 size);

}  // namespace quintet::job::interactive
#endif
