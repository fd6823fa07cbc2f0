// SPDX-License-Identifier: Apache-2.0
// Lesson 10: a sphere with an intersection shader, in world space and in object space. The acceleration structure holds
// only boxes; the intersection shader computes and reports the hit inside a box.
// scene: sphere.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};
struct HitAttributeType {
  vec3 normal;    // outward, unit, in the space of the computation
  vec2 texCoord;  // longitude and latitude in [0, 1]; the axis is z
};

uniform bool worldSpace;  // defaultval="false" help="Intersect in world space; correct only for instances with uniform scale"
uniform int show;         // defaultval="0" min="0" max="3" help="Quantity to show: 0 shaded, 1 normal, 2 texture coordinate, 3 distance / 10 and hit kind"
uniform float unitDirection;  // defaultval="0" min="0" max="1" help="Normalize the direction in object space: 0 no (correct), 1 yes (wrong distances)"

const float pi = 3.14159265359;
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(40.0)), -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001, direction, 1000.0, 0);
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
  // All sides of the box must have the same length. An ellipsoid is a sphere with a scaled instance.
  vec3 center = 0.5 * (boxMin + boxMax);
  float radius = 0.5 * (boxMax.x - boxMin.x);

  vec3 o, d;
  if (worldSpace) {
    // Transform center and radius to world space. The length of any column of the matrix is the scale.
    radius *= length(gl_ObjectToWorldEXT * vec4(1.0, 0.0, 0.0, 0.0));
    o = gl_WorldRayOriginEXT - gl_ObjectToWorldEXT * vec4(center, 1.0);
    d = gl_WorldRayDirectionEXT;
  } else {
    // Use the ray in object space. Its direction is *not* normalized, so t is the same in both spaces.
    o = gl_ObjectRayOriginEXT - center;
    d = gl_ObjectRayDirectionEXT;
    // An experiment: with unitDirection = 1 the direction has length 1, and t is wrong for scaled instances.
    if (unitDirection > 0.0) d *= pow(length(d), -unitDirection);
  }
  float t;
  uint kind = crossSphere(o, d, radius, gl_RayTminEXT, gl_RayTmaxEXT, t);
  if (kind == 0u) return;
  vec3 normal = (o + t * d) / radius;
  // The inverse matrix transforms points from world to object space, and this vector from the center too.
  vec3 local = worldSpace ? normalize(gl_WorldToObjectEXT * vec4(normal, 0.0)) : normal;
  hit.normal = normal;
  hit.texCoord = vec2(fract(atan(local.y, local.x) / (2.0 * pi)), acos(clamp(-local.z, -1.0, 1.0)) / pi);
  reportIntersectionEXT(t, kind);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 normal = hit.normal;
  if (!worldSpace) {
    mat3 normalMatrix;
    gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
    normal = normalize(normalMatrix * hit.normal);
  }
  if (show == 1) payload.color = 0.5 + 0.5 * normal;
  else if (show == 2) payload.color = vec3(hit.texCoord, 0.0);
  else if (show == 3) payload.color = vec3(gl_HitTEXT / 10.0, float(gl_HitKindEXT), 0.0);
  else {
    bool dark = ((int(16.0 * hit.texCoord.x) + int(8.0 * hit.texCoord.y)) & 1) != 0;
    payload.color = (dark ? vec3(0.2, 0.4, 0.6) : vec3(0.9, 0.85, 0.7)) * (0.15 + 0.85 * max(dot(normal, normalize(vec3(1.0, 1.5, 2.0))), 0.0));
  }
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.1, 0.12, 0.16);
}
