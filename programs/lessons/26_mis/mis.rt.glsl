// SPDX-License-Identifier: Apache-2.0
// Lesson 26: multiple importance sampling. Three lamps of different heights are reflected by four glossy strips. Sampling
// the reflection is good for smooth strips, sampling the lamps for rough strips; the balance heuristic combines both.
// scene: mis.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  float t;       // negative if the ray misses
  vec3 normal;   // of the triangle, unit, on the side of the ray's origin, world space
  int instance;
};

uniform int samples;   // defaultval="4" min="1" max="256" help="Samples of each technique per pixel and frame"
uniform int strategy;  // defaultval="2" min="0" max="2" help="Technique: 0 sample the reflection, 1 sample the lamps, 2 both with weights"
/**** COMMON END ****/

const float pi = 3.14159265359;

// Lamp i is instance i + 1. All lamps have the same power: radiance times area.
const float lampHeight[3] = float[](0.02, 0.12, 0.6);
const float lampY[3] = float[](0.35, 0.95, 1.9);
const float lampWidth = 3.6;
const float lampZ = -2.0;
const float lampPower = 2.5;

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

void trace(vec3 origin, vec3 direction, float tmax, uint flags) {
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT | flags, 0xFFu, 0u, 0u, 0u, origin, 0.0, direction, tmax, 0);
}

float lampArea(int lamp) { return lampWidth * lampHeight[lamp]; }
vec3 lampRadiance(int lamp) {
  vec3 tint = lamp == 0 ? vec3(1.0, 0.55, 0.4) : lamp == 1 ? vec3(0.6, 1.0, 0.6) : vec3(0.5, 0.7, 1.0);
  return lampPower / lampArea(lamp) * tint;
}

// The exponent of the lobe of the four strips, from left to right.
float exponentAt(vec3 position) {
  int strip = clamp(int(floor(position.x + 2.0)), 0, 3);
  return strip == 0 ? 20.0 : strip == 1 ? 150.0 : strip == 2 ? 1500.0 : 15000.0;
}

// The power lobe about the mirror direction m, and the density of its samples.
float lobe(vec3 m, vec3 wi, float n) { return (n + 2.0) / (2.0 * pi) * pow(max(dot(m, wi), 0.0), n); }
float lobeDensity(vec3 m, vec3 wi, float n) { return (n + 1.0) / (2.0 * pi) * pow(max(dot(m, wi), 0.0), n); }

// Density of the point of a lamp per solid angle: a lamp is chosen with probability 1/3, its point is uniform.
float lampDensity(int lamp, float squared, float cosLamp) { return squared / (3.0 * lampArea(lamp) * cosLamp); }

mat3 frameAround(vec3 n) {
  float s = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (s + n.z);
  float b = n.x * n.y * a;
  return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// The balance heuristic: the density of the technique that drew the sample, divided by the sum of both.
float weightOf(float own, float other) { return strategy == 2 ? own / (own + other) : 1.0; }

// Samples the lobe, and counts the lamp that the ray hits.
vec3 byReflection(vec3 position, vec3 normal, vec3 m, float n) {
  float cosAlpha = pow(random(), 1.0 / (n + 1.0));
  float sinAlpha = sqrt(max(0.0, 1.0 - cosAlpha * cosAlpha));
  float phi = 2.0 * pi * random();
  vec3 wi = frameAround(m) * vec3(sinAlpha * cos(phi), sinAlpha * sin(phi), cosAlpha);
  float cosSurface = dot(normal, wi);
  if (cosSurface <= 0.0) return vec3(0.0);
  trace(position, wi, 1e4, gl_RayFlagsNoneEXT);
  if (payload.instance < 1 || wi.z >= 0.0) return vec3(0.0);
  int lamp = payload.instance - 1;
  float density = lobeDensity(m, wi, n);
  float weight = weightOf(density, lampDensity(lamp, payload.t * payload.t, -wi.z));
  return weight * lampRadiance(lamp) * lobe(m, wi, n) * cosSurface / density;
}

// Samples a point of a lamp.
vec3 byLamp(vec3 position, vec3 normal, vec3 m, float n) {
  int lamp = min(int(3.0 * random()), 2);
  vec3 point = vec3((random() - 0.5) * lampWidth, lampY[lamp] + (random() - 0.5) * lampHeight[lamp], lampZ);
  vec3 toLamp = point - position;
  float squared = dot(toLamp, toLamp);
  vec3 wi = toLamp * inversesqrt(squared);
  float cosSurface = dot(normal, wi);
  if (cosSurface <= 0.0 || wi.z >= 0.0) return vec3(0.0);
  trace(position, wi, sqrt(squared) - 2e-4, gl_RayFlagsTerminateOnFirstHitEXT);
  if (payload.t >= 0.0) return vec3(0.0);
  float density = lampDensity(lamp, squared, -wi.z);
  float weight = weightOf(density, lobeDensity(m, wi, n));
  return weight * lampRadiance(lamp) * lobe(m, wi, n) * cosSurface / density;
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 eye = vec3(0.0, 1.6, 5.5);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(32.0)) - vec2(0.0, 0.16), -1.0));
  uint pixel = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;

  trace(eye, direction, 1e4, gl_RayFlagsNoneEXT);
  vec3 sum = vec3(0.0);
  if (payload.instance > 0) {
    sum = float(samples) * lampRadiance(payload.instance - 1);
  } else if (payload.instance == 0) {
    vec3 normal = payload.normal;
    vec3 position = eye + payload.t * direction + 1e-4 * normal;
    vec3 m = reflect(direction, normal);
    float n = exponentAt(position);
    for (int s = 0; s < samples; ++s) {
      randomState = hash(pixel ^ hash(uint(frameID * samples + s)));
      if (strategy != 1) sum += byReflection(position, normal, m, n);
      if (strategy != 0) sum += byLamp(position, normal, m, n);
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
