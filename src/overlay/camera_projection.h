// SPDX-License-Identifier: Apache-2.0
// From world space to the image of a camera. A lens is replaced by a pinhole at its center.
#ifndef QUINTET_OVERLAY_CAMERA_PROJECTION_H
#define QUINTET_OVERLAY_CAMERA_PROJECTION_H

#include "base/math.h"
#include "scene/model/scene.h"

namespace quintet::overlay {

class CameraProjection {
 public:
  // `size`: of the image, pixels, > 0.
  CameraProjection(const scene::Camera& camera, uvec2 size);

  // Camera space, meters: x right, y up, z < 0 in front of the camera.
  vec3 toCamera(const vec3& world) const { return vec3(cameraFromWorld_ * vec4(world, 1.0f)); }
  const mat4& cameraFromWorld() const { return cameraFromWorld_; }
  // Pixels from the top left corner. For a perspective camera, `point` is in front of it.
  vec2 toImage(const vec3& point) const;
  // Changes linearly over the image along a line; larger is nearer: 1/depth of a perspective camera, else -depth.
  // `depth`: -z, meters.
  float reversedDepth(float depth) const { return orthographic_ ? -depth : 1.0f / depth; }
  // Meters per pixel at this depth.
  float pixelSize(float depth) const { return 2.0f * halfSize_.y / size_.y * (orthographic_ ? 1.0f : depth); }
  bool orthographic() const { return orthographic_; }

 private:
  mat4 cameraFromWorld_;
  vec2 halfSize_;  // of the image, meters, at depth 1 m
  vec2 size_;      // pixels
  bool orthographic_;
};

}  // namespace quintet::overlay
#endif
