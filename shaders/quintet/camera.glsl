// SPDX-License-Identifier: Apache-2.0
// Camera rays: pinhole, thin lens (Kolb et al. 1995, thin-lens model) and orthographic.
#ifndef QUINTET_CAMERA_GLSL
#define QUINTET_CAMERA_GLSL

#include "frame.glsl"
#include "sampling/warp.glsl"

struct Ray {
  vec3 origin;
  vec3 direction;  // unit
};

// Offset from the pixel's center in pixels, distributed as a tent of radius 0.75. With this filter importance
// sampling (Ernst et al. 2006), each pixel is the mean of its own samples.
vec2 filterOffset(vec2 u) {
  const vec2 v = 2.0 * u - 1.0;
  return 0.75 * sign(v) * (1.0 - sqrt(1.0 - abs(v)));
}

vec3 cameraToWorld(CameraData camera, vec4 p) {
  return vec3(dot(camera.worldFromCamera[0], p), dot(camera.worldFromCamera[1], p), dot(camera.worldFromCamera[2], p));
}

// Ray through image point `pixel` (in pixels from the top left corner; pixel centers at .5); `lens` in [0,1)².
Ray cameraRay(vec2 pixel, vec2 lens) {
  const CameraData camera = frame.camera;
  const vec2 ndc = vec2(2.0, -2.0) * pixel / vec2(frame.width, frame.height) + vec2(-1.0, 1.0);
  const vec2 plane = ndc * camera.halfSize;
  vec3 origin = vec3(0.0);
  vec3 direction = vec3(plane, -1.0);
  if (camera.orthographic != 0u) {
    origin = vec3(plane, 0.0);
    direction = vec3(0.0, 0.0, -1.0);
  } else if (camera.apertureRadius > 0.0) {
    origin = vec3(camera.apertureRadius * sampleDisk(lens), 0.0);
    direction = camera.focusDistance * direction - origin;
  }
  Ray ray;
  ray.origin = cameraToWorld(camera, vec4(origin, 1.0));
  ray.direction = normalize(cameraToWorld(camera, vec4(direction, 0.0)));
  return ray;
}

// A world position in the space of a camera.
vec3 cameraFromWorld(CameraData camera, vec3 world) {
  const vec4 rows[3] = camera.worldFromCamera;
  const vec3 p = world - vec3(rows[0].w, rows[1].w, rows[2].w);
  return rows[0].xyz * p.x + rows[1].xyz * p.y + rows[2].xyz * p.z;
}
vec3 cameraFromWorld(vec3 world) { return cameraFromWorld(frame.camera, world); }

// Depth along the camera's axis in meters; positive in front of the camera.
float cameraDepth(vec3 world) { return -cameraFromWorld(world).z; }

// Projection of a world position in front of a camera, in pixels from the top left corner.
vec2 imagePoint(CameraData camera, vec3 world) {
  const vec3 p = cameraFromWorld(camera, world);
  const vec2 plane = camera.orthographic != 0u ? p.xy : p.xy / -p.z;
  const vec2 ndc = plane / camera.halfSize;
  return vec2(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * vec2(frame.width, frame.height);
}
vec2 imagePoint(vec3 world) { return imagePoint(frame.camera, world); }

#endif
