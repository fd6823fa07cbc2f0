// SPDX-License-Identifier: Apache-2.0
// Lesson 27: Russian roulette. A path tracer ends paths with a small weight at random and divides the weight of the others
// by the probability to continue. The mean stays the same, and most paths are short.
// scene: roulette.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  float t;       // negative if the ray misses
  vec3 normal;   // of the triangle, unit, on the side of the ray's origin, world space
  int instance;
};

uniform int samples;    // defaultval="4" min="1" max="256" help="Samples per pixel and frame"
uniform int bounces;    // defaultval="64" min="1" max="256" help="Maximum number of scattering events of a path"
uniform bool roulette;  // defaultval="true" help="End paths at random"
uniform vec3 emission;  // defaultval="16, 13, 9" help="Radiance of the lamp"
uniform int show;       // defaultval="0" min="0" max="1" help="Quantity to show: 0 radiance, 1 scattering events of a path / 64"
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

// The light of the lamp that reaches the surface and leaves it: next-event estimation as in lesson 25.
vec3 directLight(vec3 position, vec3 normal, vec3 albedo) {
  vec3 point = lampCenter + lampHalf * vec3(2.0 * random() - 1.0, 0.0, 2.0 * random() - 1.0);
  vec3 toLamp = point - position;
  float squared = dot(toLamp, toLamp);
  vec3 wi = toLamp * inversesqrt(squared);
  float cosines = max(dot(normal, wi), 0.0) * max(wi.y, 0.0);
  if (cosines <= 0.0) return vec3(0.0);
  trace(position, wi, sqrt(squared) - 2e-4, gl_RayFlagsTerminateOnFirstHitEXT);
  return payload.t < 0.0 ? albedo / pi * emission * cosines * lampArea / squared : vec3(0.0);
}

// Returns the radiance of a path, and in `events` how often it is scattered.
vec3 pathRadiance(vec3 origin, vec3 direction, out int events) {
  vec3 radiance = vec3(0.0);
  vec3 weight = vec3(1.0);
  events = 0;
  for (int depth = 0; depth < bounces; ++depth) {
    trace(origin, direction, 1e4, gl_RayFlagsNoneEXT);
    if (payload.t < 0.0) break;
    if (payload.instance == lampInstance && direction.y > 0.0) {
      if (depth == 0) radiance += emission;
      break;
    }
    vec3 normal = payload.normal;
    vec3 albedo = albedoOf(payload.instance);
    origin += payload.t * direction + 1e-4 * normal;
    radiance += weight * directLight(origin, normal, albedo);
    direction = cosineDirection(normal);
    weight *= albedo;
    events++;

    if (roulette && depth >= 2) {
      float survival = min(max(weight.x, max(weight.y, weight.z)), 0.95);
      if (random() >= survival) break;
      weight /= survival;
    }
  }
  return radiance;
}

void main() { /**** RAY GENERATION SHADER ****/
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  uint pixel = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;
  vec3 sum = vec3(0.0);
  for (int s = 0; s < samples; ++s) {
    randomState = hash(pixel ^ hash(uint(frameID * samples + s)));
    vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + vec2(random(), random())) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
    vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(38.0)), -1.0));
    int events;
    vec3 radiance = pathRadiance(vec3(0.0, 1.0, 3.9), direction, events);
    sum += show == 0 ? radiance : vec3(float(events) / 64.0);
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
