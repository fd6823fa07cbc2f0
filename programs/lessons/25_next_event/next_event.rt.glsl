// SPDX-License-Identifier: Apache-2.0
// Lesson 25: next-event estimation. The direct light of a small lamp, estimated in two ways: by random directions, of
// which few reach the lamp, and by random points of the lamp.
// scene: next_event.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  float t;       // negative if the ray misses
  vec3 normal;   // of the triangle, unit, on the side of the ray's origin, world space
  int instance;
};

uniform int samples;     // defaultval="4" min="1" max="256" help="Samples per pixel and frame"
uniform bool nextEvent;  // defaultval="true" help="Sample points of the lamp; otherwise directions of the surface"
uniform vec3 emission;   // defaultval="16, 13, 9" help="Radiance of the lamp"
/**** COMMON END ****/

const float pi = 3.14159265359;

// The lamp: a square below the ceiling that faces down (instance 1 of the scene).
const int lampInstance = 1;
const vec3 lampCenter = vec3(0.0, 1.98, 0.0);
const float lampHalf = 0.25;
const float lampArea = 4.0 * lampHalf * lampHalf;

uint randomState;
uint hash(uint x) {
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
  return (x >> 22u) ^ x;
}
float random() {
  randomState = randomState * 747796405u + 2891336453u;
  uint x = ((randomState >> ((randomState >> 28u) + 4u)) ^ randomState) * 277803737u;
  return float(((x >> 22u) ^ x) >> 8u) / 16777216.0;
}

// By instance: 0 white walls, 1 lamp (back side), 2 red wall, 3 green wall, 4 and 5 blocks.
vec3 albedoOf(int instance) {
  return instance == 2 ? vec3(0.63, 0.065, 0.05) : instance == 3 ? vec3(0.14, 0.45, 0.091) : vec3(0.73);
}

// Returns a cosine-weighted direction about n: a point on the unit sphere around the tip of n.
vec3 cosineDirection(vec3 n) {
  float z = 1.0 - 2.0 * random();
  float angle = 2.0 * pi * random();
  vec3 d = n + vec3(sqrt(max(0.0, 1.0 - z * z)) * vec2(cos(angle), sin(angle)), z);
  return dot(d, d) > 1e-12 ? normalize(d) : n;
}

void trace(vec3 origin, vec3 direction, float tmax, uint flags) {
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT | flags, 0xFFu, 0u, 0u, 0u, origin, 0.0, direction, tmax, 0);
}

// A sample by direction: the density is cos / pi, so the estimate is albedo · L. Most directions miss the lamp.
vec3 byDirection(vec3 position, vec3 normal, vec3 albedo) {
  vec3 wi = cosineDirection(normal);
  trace(position, wi, 1e4, gl_RayFlagsNoneEXT);
  return payload.instance == lampInstance && wi.y > 0.0 ? albedo * emission : vec3(0.0);
}

// A sample by point: uniform over the area of the lamp. The estimate is f · L · cos · cos' / distance² · area.
vec3 byPoint(vec3 position, vec3 normal, vec3 albedo) {
  vec3 point = lampCenter + lampHalf * vec3(2.0 * random() - 1.0, 0.0, 2.0 * random() - 1.0);
  vec3 toLamp = point - position;
  float squared = dot(toLamp, toLamp);
  vec3 wi = toLamp * inversesqrt(squared);
  float cosSurface = dot(normal, wi);
  float cosLamp = wi.y;
  if (cosSurface <= 0.0 || cosLamp <= 0.0) return vec3(0.0);
  trace(position, wi, sqrt(squared) - 2e-4, gl_RayFlagsTerminateOnFirstHitEXT);
  if (payload.t >= 0.0) return vec3(0.0);
  return albedo / pi * emission * cosSurface * cosLamp / squared * lampArea;
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 eye = vec3(0.0, 1.0, 3.9);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(38.0)), -1.0));
  uint pixel = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;

  trace(eye, direction, 1e4, gl_RayFlagsNoneEXT);
  vec3 sum = vec3(0.0);
  if (payload.instance == lampInstance && direction.y > 0.0) {
    sum = float(samples) * emission;
  } else if (payload.t >= 0.0) {
    vec3 normal = payload.normal;
    vec3 position = eye + payload.t * direction + 1e-4 * normal;
    vec3 albedo = albedoOf(payload.instance);
    for (int s = 0; s < samples; ++s) {
      randomState = hash(pixel ^ hash(uint(frameID * samples + s)));
      sum += nextEvent ? byPoint(position, normal, albedo) : byDirection(position, normal, albedo);
    }
  }
  // The mean over all frames is computed in linear values and stored with gamma 2.2.
  vec3 before = pow(gsnGetPreviousPixel().rgb, vec3(2.2));
  vec3 linear = (before * float(frameID) + sum / float(samples)) / float(frameID + 1);
  gsnSetPixel(vec4(pow(linear, vec3(1.0 / 2.2)), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * cross(p1 - p0, p2 - p0));
  payload.t = gl_HitTEXT;
  payload.normal = dot(normal, gl_WorldRayDirectionEXT) > 0.0 ? -normal : normal;
  payload.instance = gl_InstanceID;
}

void main() { /**** MISS SHADER ****/
  payload.t = -1.0;
  payload.normal = vec3(0.0);
  payload.instance = -1;
}
