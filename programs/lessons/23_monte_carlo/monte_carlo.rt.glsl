// SPDX-License-Identifier: Apache-2.0
// Lesson 23: an integral by random numbers. The light that a diffuse surface reflects is an integral over all directions.
// It is estimated by the mean over random directions, which are uniform over the hemisphere.
// scene: monte_carlo.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  float t;       // negative if the ray misses
  vec3 normal;   // of the triangle, unit, on the side of the ray's origin, world space
  int instance;
};

uniform int samples;  // defaultval="1" min="1" max="256" help="Samples per pixel and frame"
/**** COMMON END ****/

const float pi = 3.14159265359;

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

// The light: a sky that is white at the horizon and blue above.
vec3 skyRadiance(vec3 direction) {
  return mix(vec3(1.0, 0.95, 0.85), vec3(0.25, 0.5, 1.0), clamp(direction.y, 0.0, 1.0));
}

// By instance: floor, block, roof.
vec3 albedoOf(int instance) {
  return instance == 0 ? vec3(0.6) : instance == 1 ? vec3(0.8, 0.45, 0.2) : vec3(0.35, 0.6, 0.4);
}

// Returns a direction that is uniform over the hemisphere about n: a point on the unit sphere, mirrored to the side of n.
vec3 uniformDirection(vec3 n) {
  float z = 1.0 - 2.0 * random();
  float angle = 2.0 * pi * random();
  vec3 d = vec3(sqrt(max(0.0, 1.0 - z * z)) * vec2(cos(angle), sin(angle)), z);
  return dot(d, n) < 0.0 ? -d : d;
}

void trace(vec3 origin, vec3 direction, uint flags) {
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT | flags, 0xFFu, 0u, 0u, 0u, origin, 0.0, direction, 1e4, 0);
}

// One sample of the reflected radiance: integrand / density.
vec3 estimate(vec3 position, vec3 normal, vec3 albedo) {
  vec3 wi = uniformDirection(normal);
  float density = 1.0 / (2.0 * pi);
  trace(position, wi, gl_RayFlagsTerminateOnFirstHitEXT);
  vec3 incoming = payload.t < 0.0 ? skyRadiance(wi) : vec3(0.0);
  return albedo / pi * incoming * dot(normal, wi) / density;
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 eye = vec3(0.0, 2.2, 6.0);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(35.0)) - vec2(0.0, 0.28), -1.0));
  uint pixel = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;

  trace(eye, direction, gl_RayFlagsNoneEXT);
  vec3 sum = vec3(0.0);
  if (payload.t < 0.0) {
    sum = float(samples) * skyRadiance(direction);
  } else {
    vec3 normal = payload.normal;
    vec3 position = eye + payload.t * direction + 1e-4 * normal;
    vec3 albedo = albedoOf(payload.instance);
    for (int s = 0; s < samples; ++s) {
      randomState = hash(pixel ^ hash(uint(frameID * samples + s)));
      sum += estimate(position, normal, albedo);
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
