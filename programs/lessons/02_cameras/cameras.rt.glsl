// SPDX-License-Identifier: Apache-2.0
// Lesson 02: a camera anywhere. Three ways to compute the same camera ray: a frame of vectors (look-at), the inverse of
// the model-view-projection matrix, and a point on the far plane. The color is the distance of a hit, or the direction
// of a ray that misses.
// scene: cameras.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};

uniform int way;          // defaultval="0" min="0" max="2" help="Method: 0 look-at frame, 1 inverse of the MVP matrix, 2 point on the far plane"
uniform vec3 eye;         // defaultval="3, 2, 4" unit="m" help="Position of the camera"
uniform vec3 target;      // defaultval="0, 0.5, 0" unit="m" help="Point that the camera looks at"
uniform float fieldOfView; // defaultval="40" min="1" max="179" unit="deg" help="Vertical field of view"

const float nearPlane = 0.1;
const float farPlane = 100.0;
/**** COMMON END ****/

// Transforms from camera space (x right, y up, looking along -z) to world space.
mat4 worldFromCamera() {
  vec3 back = normalize(eye - target);
  vec3 right = normalize(cross(vec3(0.0, 1.0, 0.0), back));
  vec3 up = cross(back, right);
  return mat4(vec4(right, 0.0), vec4(up, 0.0), vec4(back, 0.0), vec4(eye, 1.0));
}

// The perspective matrix of OpenGL: clip-space z from -1 (near) to 1 (far).
mat4 clipFromCamera(float aspect) {
  float f = 1.0 / tan(0.5 * radians(fieldOfView));
  float depth = nearPlane - farPlane;
  return mat4(f / aspect, 0.0, 0.0, 0.0,
              0.0, f, 0.0, 0.0,
              0.0, 0.0, (farPlane + nearPlane) / depth, -1.0,
              0.0, 0.0, 2.0 * farPlane * nearPlane / depth, 0.0);
}

// 0: a point of the image plane in camera space.
vec3 byLookAt(vec2 ndc, float aspect) {
  float halfHeight = tan(0.5 * radians(fieldOfView));
  vec3 inCamera = vec3(ndc * vec2(aspect, 1.0) * halfHeight, -1.0);
  return normalize(mat3(worldFromCamera()) * inCamera);
}

// 1: the pixel's points on the near and the far plane, transformed to world space by the inverse of the whole matrix.
vec3 byInverseMatrix(vec2 ndc, float aspect) {
  mat4 worldFromClip = inverse(clipFromCamera(aspect) * inverse(worldFromCamera()));
  vec4 a = worldFromClip * vec4(ndc, -1.0, 1.0);
  vec4 b = worldFromClip * vec4(ndc, 1.0, 1.0);
  return normalize(b.xyz / b.w - a.xyz / a.w);
}

// 2: the pixel's point on the far plane in camera space, by the inverse projection; its direction in world space.
vec3 byFarPlane(vec2 ndc, float aspect) {
  vec4 far = inverse(clipFromCamera(aspect)) * vec4(ndc, 1.0, 1.0);
  return normalize((worldFromCamera() * vec4(far.xyz / far.w, 0.0)).xyz);
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction;
  if (way == 0) direction = byLookAt(ndc, aspect);
  else if (way == 1) direction = byInverseMatrix(ndc, aspect);
  else direction = byFarPlane(ndc, aspect);

  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, nearPlane, direction, farPlane, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(gl_HitTEXT / 10.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = 0.5 + 0.5 * gl_WorldRayDirectionEXT;
}
