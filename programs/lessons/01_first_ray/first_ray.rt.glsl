// SPDX-License-Identifier: Apache-2.0
// Lesson 01: the first ray. One ray per pixel shows red where it hits a surface and black where it misses.
// scene: first_ray.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;  // what the hit and miss shaders return to the ray generation shader
};

uniform float fieldOfView; // defaultval="45" min="1" max="179" unit="deg" help="Vertical field of view"
uniform vec3 hitColor;     // defaultval="1, 0, 0" type="color" help="Color of surfaces"
/**** COMMON END ****/

// Returns the direction of the ray through `point` of the image plane ((0, 0) bottom left, (1, 1) top right) for a
// camera at the origin that looks along -z. The plane is at distance 1 and extends from -tan(fov / 2) to tan(fov / 2)
// in y.
vec3 cameraDirection(vec2 point, float aspect) {
  float halfHeight = tan(0.5 * radians(fieldOfView));
  vec2 plane = (2.0 * point - 1.0) * vec2(aspect, 1.0) * halfHeight;
  return normalize(vec3(plane, -1.0));
}

void main() { /**** RAY GENERATION SHADER ****/
  // + 0.5: the center of the pixel.
  vec2 point = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy);
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);

  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u,  // flags, mask, hit offset, hit stride, miss index
              vec3(0.0), 0.001, cameraDirection(point, aspect), 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = hitColor;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
