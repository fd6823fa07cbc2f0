// SPDX-License-Identifier: Apache-2.0
// Lesson 22: a path tracer in one file. Diffuse surfaces and a lamp in the Cornell box. At each surface the lamp is
// sampled directly (next-event estimation), and the path continues in a direction with cosine-weighted density. The
// average over the frames converges to the light of paths with at most `bounces` scattering events.
// scene: path_tracer.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  float t;       // negative if the ray misses
  vec3 normal;   // of the triangle, unit, on the side of the ray's origin, world space
  int instance;
};

uniform int samples;  // defaultval="4" min="1" max="256" help="Samples per pixel and frame"
uniform int bounces;  // defaultval="8" min="0" max="64" help="Maximum number of scattering events of a path"
uniform vec3 emission; // defaultval="16, 13, 9" help="Radiance of the lamp"
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

// Returns the radiance of a path. The lamp's emission counts only if a camera ray hits it, because the samples of the
// lamp already include all later hits.
vec3 pathRadiance(vec3 origin, vec3 direction) {
  vec3 radiance = vec3(0.0);
  vec3 weight = vec3(1.0);
  // One traceRayEXT serves both kinds of rays, because each call costs compile time.
  bool shadow = false;
  float tmax = 1e4;
  vec3 pending = vec3(0.0);  // contribution of the lamp if the shadow ray misses
  vec3 nextOrigin = vec3(0.0);
  vec3 nextDirection = vec3(0.0);
  for (int depth = 0; depth <= bounces;) {
    uint flags = gl_RayFlagsOpaqueEXT | (shadow ? gl_RayFlagsTerminateOnFirstHitEXT : gl_RayFlagsNoneEXT);
    traceRayEXT(topLevelAS, flags, 0xFFu, 0u, 0u, 0u, origin, 0.0, direction, tmax, 0);
    if (shadow) {
      if (payload.t < 0.0) radiance += pending;
      shadow = false;
      origin = nextOrigin;
      direction = nextDirection;
      tmax = 1e4;
      depth++;
      continue;
    }
    if (payload.t < 0.0) break;
    vec3 normal = payload.normal;
    int instance = payload.instance;
    if (instance == lampInstance && direction.y > 0.0) {
      if (depth == 0) radiance += weight * emission;
      break;
    }
    if (depth == bounces) break;
    vec3 position = origin + payload.t * direction + 1e-4 * normal;
    weight *= albedoOf(instance);

    // A point of the lamp, uniform over its area. The estimate is f · L · cos · cos' · area / distance².
    vec3 target = lampCenter + lampHalf * vec3(2.0 * random() - 1.0, 0.0, 2.0 * random() - 1.0);
    vec3 toLamp = target - position;
    float squared = dot(toLamp, toLamp);
    vec3 wi = toLamp * inversesqrt(squared);
    float cosines = max(dot(normal, wi), 0.0) * max(wi.y, 0.0);
    pending = weight / pi * emission * cosines * lampArea / squared;

    nextOrigin = position;
    nextDirection = cosineDirection(normal);
    shadow = true;
    origin = position;
    direction = wi;
    tmax = sqrt(squared) - 2e-4;
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
    sum += pathRadiance(vec3(0.0, 1.0, 3.9), direction);
  }
  // Averaged in linear values, stored with gamma 2.2.
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
