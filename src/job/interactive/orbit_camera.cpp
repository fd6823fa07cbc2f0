// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/orbit_camera.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace quintet::job::interactive {
namespace {

constexpr float kFrameMargin = 1.04f;
constexpr vec3 kWorldUp{0, 1, 0};

// Of a pixel at the center's depth.
float metersPerPixel(const OrbitCamera& camera, uvec2 size) {
  return 2.0f * camera.distance * std::tan(0.5f * camera.verticalFov) / static_cast<float>(size.y);
}

quat turned(const quat& worldFromCamera, float left, float up) {
  return glm::normalize(glm::angleAxis(glm::radians(left), kWorldUp) * worldFromCamera *
                        glm::angleAxis(glm::radians(up), vec3(1, 0, 0)));
}

}  // namespace

float OrbitCamera::depthOf(const vec3& point) const {
  return glm::dot(point - eye(), worldFromCamera * vec3(0, 0, -1));
}

vec3 OrbitCamera::eye() const { return center + worldFromCamera * vec3(0, 0, distance); }

CameraRequest OrbitCamera::request() const {
  CameraRequest request;
  request.lookFrom = eye();
  request.lookAt = center;
  request.up = worldFromCamera * vec3(0, 1, 0);
  request.verticalFov = glm::degrees(verticalFov);
  request.apertureRadius = apertureRadius;
  request.focusDistance = focusDistance;
  return request;
}

OrbitCamera orbitCamera(const scene::Camera& camera, const vec3& center) {
  if (camera.orthographic) throw UsageError("the camera is orthographic; navigation requires a perspective camera");
  OrbitCamera result;
  const vec3 eye(camera.worldFromCamera[3]), forward = -vec3(camera.worldFromCamera[2]);
  const float depth = glm::dot(center - eye, forward);
  result.worldFromCamera = glm::normalize(glm::quat_cast(mat3(camera.worldFromCamera)));
  result.distance = depth > 0.0f ? depth : camera.focusDistance;
  result.center = eye + result.distance * forward;
  result.verticalFov = camera.verticalFov;
  result.apertureRadius = camera.apertureRadius;
  result.focusDistance = camera.focusDistance;
  return result;
}

OrbitCamera orbit(OrbitCamera camera, float right, float up, const vec3& pivot) {
  const vec3 offset = glm::inverse(camera.worldFromCamera) * (camera.center - pivot);
  camera.worldFromCamera = turned(camera.worldFromCamera, right, -up);
  camera.center = pivot + camera.worldFromCamera * offset;
  return camera;
}

OrbitCamera pan(OrbitCamera camera, vec2 pixels, uvec2 size) {
  const vec2 meters = metersPerPixel(camera, size) * pixels;
  camera.center += camera.worldFromCamera * vec3(-meters.x, meters.y, 0);
  return camera;
}

OrbitCamera zoom(OrbitCamera camera, float factor, vec2 pixel, uvec2 size) {
  const vec2 fromMiddle = pixel - 0.5f * vec2(size);
  const vec2 meters = metersPerPixel(camera, size) * (1.0f - 1.0f / factor) * fromMiddle;
  camera.center += camera.worldFromCamera * vec3(meters.x, -meters.y, 0);
  camera.distance /= factor;
  return camera;
}

OrbitCamera fly(OrbitCamera camera, vec3 meters, float yaw, float pitch) {
  const vec3 eye = camera.eye() + camera.worldFromCamera * vec3(meters.x, meters.y, -meters.z);
  camera.worldFromCamera = turned(camera.worldFromCamera, yaw, pitch);
  camera.center = eye - camera.worldFromCamera * vec3(0, 0, camera.distance);
  return camera;
}

OrbitCamera frame(OrbitCamera camera, const Bounds3& bounds, uvec2 size) {
  const float radius = bounds.empty() ? 0.0f : 0.5f * glm::length(bounds.extent());
  if (!(radius > 0.0f) || !std::isfinite(radius)) return camera;
  const float slope = std::tan(0.5f * camera.verticalFov);
  const float aspect = static_cast<float>(size.x) / static_cast<float>(size.y);
  const float halfAngle = std::atan(slope * std::min(aspect, 1.0f));
  camera.center = bounds.center();
  camera.distance = kFrameMargin * radius / std::sin(halfAngle);
  camera.focusDistance = camera.distance;
  return camera;
}

}  // namespace quintet::job::interactive
