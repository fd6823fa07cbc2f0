// SPDX-License-Identifier: Apache-2.0
// Lesson 11: 10,000 spheres. One instance shows one BLAS of 10,000 boxes; gl_PrimitiveID is the box that the
// intersection shader tests.
// scene: many_spheres.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
  bool lampIsSeen;
};
struct HitAttributeType {
  vec3 normal;
};

uniform vec3 lampPosition; // defaultval="40, 60, 50" unit="m" help="Position of the lamp"

// Returns a color for each sphere.
vec3 colorOf(int primitive) {
  uint h = uint(primitive) * 747796405u + 2891336453u;
  h = ((h >> ((h >> 28u) + 4u)) ^ h) * 277803737u;
  h = (h >> 22u) ^ h;
  return 0.2 + 0.7 * vec3(h & 255u, (h >> 8u) & 255u, (h >> 16u) & 255u) / 255.0;
}
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(35.0)), -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 45.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

// Finds the nearest solution of |o + t d|² = r² in [tmin, tmax]. Returns 1 if the ray enters the sphere there, 2 if it
// leaves, 0 if it misses.
uint crossSphere(vec3 o, vec3 d, float radius, float tmin, float tmax, out float t) {
  float a = dot(d, d);
  float b = dot(o, d);
  vec3 nearest = o - (b / a) * d;  // point of the ray closest to the center; keeps rounding errors small
  float discriminant = a * (radius * radius - dot(nearest, nearest));
  t = 0.0;
  if (discriminant < 0.0) return 0u;
  float q = sqrt(discriminant);
  t = (-b - q) / a;
  if (t >= tmin && t <= tmax) return 1u;
  t = (-b + q) / a;
  return t >= tmin && t <= tmax ? 2u : 0u;
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 boxMin, boxMax;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, boxMin, boxMax);
  vec3 o = gl_ObjectRayOriginEXT - 0.5 * (boxMin + boxMax);
  float radius = 0.5 * (boxMax.x - boxMin.x);
  float t;
  uint kind = crossSphere(o, gl_ObjectRayDirectionEXT, radius, gl_RayTminEXT, gl_RayTmaxEXT, t);
  if (kind == 0u) return;
  hit.normal = (o + t * gl_ObjectRayDirectionEXT) / radius;
  reportIntersectionEXT(t, kind);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 color = colorOf(gl_PrimitiveID);
  vec3 normal = hit.normal;
  vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  vec3 toLamp = lampPosition - position;
  float lampDistance = length(toLamp);
  payload.lampIsSeen = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              position + 0.001 * normal, 0.0, toLamp / lampDistance, lampDistance, 0);
  float light = payload.lampIsSeen ? max(dot(normal, toLamp / lampDistance), 0.0) : 0.0;
  payload.color = color * (0.12 + 0.88 * light);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.75, 0.82, 0.9);
  payload.lampIsSeen = true;
}
