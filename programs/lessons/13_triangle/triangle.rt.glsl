// SPDX-License-Identifier: Apache-2.0
// Lesson 13: a triangle with an intersection shader, by the method of Möller and Trumbore (1997). Half of the scene's
// triangles use the built-in test, half are boxes with a triangle inside. The colors are the barycentric coordinates of
// both.
// scene: triangle.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};
struct HitAttributeType {
  vec2 barycentric;
};

uniform int show;  // defaultval="0" min="0" max="1" help="Quantity to show: 0 barycentrics, 1 distance / 10 and side (green is front)"
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(40.0)), -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 5.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 boxMin, boxMax;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, boxMin, boxMax);
  vec3 size = boxMax - boxMin;
  // Upright in the middle of the box, counter-clockwise seen from +z.
  vec3 a = boxMin + vec3(0.0, 0.0, 0.5 * size.z);
  vec3 b = boxMin + vec3(size.x, 0.0, 0.5 * size.z);
  vec3 c = boxMin + vec3(0.5 * size.x, size.y, 0.5 * size.z);

  // a + u (b - a) + v (c - a) = o + t d: three equations for t, u and v, solved by Cramer's rule.
  vec3 i = b - a;
  vec3 j = c - a;
  vec3 k = gl_ObjectRayOriginEXT - a;
  vec3 d = gl_ObjectRayDirectionEXT;
  vec3 dxj = cross(d, j);
  float determinant = dot(dxj, i);  // its sign is the side from which the ray comes
  if (determinant == 0.0) return;   // parallel
  float u = dot(dxj, k) / determinant;
  if (u < 0.0 || u > 1.0) return;
  vec3 kxi = cross(k, i);
  float v = dot(kxi, d) / determinant;
  if (v < 0.0 || u + v > 1.0) return;
  float t = dot(kxi, j) / determinant;
  if (t < gl_RayTminEXT || t > gl_RayTmaxEXT) return;
  hit.barycentric = vec2(u, v);
  reportIntersectionEXT(t, determinant > 0.0 ? 0x7Eu : 0x7Fu);  // the built-in kinds 0xFE and 0xFF without the reserved bit
}

void main() { /**** CLOSEST-HIT SHADER ****/
  bool builtIn = gl_HitKindEXT >= 0x80u;
  vec2 uv = builtIn ? baryCoord : hit.barycentric;
  bool front = (gl_HitKindEXT & 1u) == 0u;
  if (show == 0) payload.color = vec3(1.0 - uv.x - uv.y, uv);
  else payload.color = vec3(gl_HitTEXT / 10.0, front ? 1.0 : 0.0, builtIn ? 1.0 : 0.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
