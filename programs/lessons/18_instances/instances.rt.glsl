// SPDX-License-Identifier: Apache-2.0
// Lesson 18: instances. Many instances of one mesh, each with a transform, a mask, flags and a custom index. The custom
// index selects the color; a ray sees only instances whose mask shares a bit with its cull mask.
// scene: instances.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};

uniform int cullMask;      // defaultval="255" min="0" max="255" help="Cull mask of the rays: bits 1, 2 and 4 show the three rows"
uniform bool cullBack;     // defaultval="false" help="Cull back-facing triangles"

const vec3 palette[4] = vec3[](vec3(0.8, 0.25, 0.2), vec3(0.25, 0.6, 0.3), vec3(0.2, 0.4, 0.8), vec3(0.8, 0.7, 0.2));
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(40.0)), -1.0));
  uint flags = cullBack ? gl_RayFlagsCullBackFacingTrianglesEXT : gl_RayFlagsNoneEXT;
  traceRayEXT(topLevelAS, flags, uint(cullMask), 0u, 0u, 0u, vec3(0.0, 0.0, 8.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  // gl_InstanceID is the index in the scene, gl_InstanceCustomIndexEXT a number of your choice (24 bits).
  vec3 base = palette[gl_InstanceCustomIndexEXT & 3];
  float stripe = (gl_InstanceID & 1) != 0 ? 1.0 : 0.8;
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * cross(p1 - p0, p2 - p0));
  // The winding in object space determines the front; the flip_facing flag reverses it.
  bool front = gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT;
  payload.color = base * stripe * (0.25 + 0.75 * abs(dot(normal, normalize(vec3(1.0, 1.0, 2.0))))) * (front ? 1.0 : 0.5);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.05);
}
