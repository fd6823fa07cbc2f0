// SPDX-License-Identifier: Apache-2.0
// Lesson 24: importance sampling. The integral of lesson 23, with directions whose density is proportional to the cosine:
// the cosine and the density cancel, and the noise is lower.
// scene: cosine_sampling.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  float t;       // negative if the ray misses
  vec3 normal;   // of the triangle, unit, on the side of the ray's origin, world space
  int instance;
};

uniform int samples;  // defaultval="1" min="1" max="256" help="Samples per pixel and frame"
uniform int method;   // defaultval="1" min="0" max="1" help="Directions: 0 uniform, 1 cosine-weighted"
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

// Returns a matrix whose columns are two tangents and the unit vector n (Duff et al. 2017).
mat3 frameAround(vec3 n) {
  float s = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (s + n.z);
  float b = n.x * n.y * a;
  return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// A direction in the hemisphere about z: its height is uniform.
vec3 uniformLocal(float u, float v) {
  float r = sqrt(max(0.0, 1.0 - u * u));
  return vec3(r * cos(2.0 * pi * v), r * sin(2.0 * pi * v), u);
}

// A uniform point of the unit disk, projected up to the hemisphere: density cos / pi (Malley).
vec3 cosineLocal(float u, float v) {
  float r = sqrt(u);
  return vec3(r * cos(2.0 * pi * v), r * sin(2.0 * pi * v), sqrt(1.0 - u));
}

void trace(vec3 origin, vec3 direction, uint flags) {
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT | flags, 0xFFu, 0u, 0u, 0u, origin, 0.0, direction, 1e4, 0);
}

// One sample of the reflected radiance: integrand / density.
vec3 estimate(vec3 position, vec3 normal, vec3 albedo) {
  float u = random();
  float v = random();
  vec3 local = method == 0 ? uniformLocal(u, v) : cosineLocal(u, v);
  float cosine = local.z;
  float density = method == 0 ? 1.0 / (2.0 * pi) : cosine / pi;
  vec3 wi = frameAround(normal) * local;
  if (density <= 0.0) return vec3(0.0);
  trace(position, wi, gl_RayFlagsTerminateOnFirstHitEXT);
  vec3 incoming = payload.t < 0.0 ? skyRadiance(wi) : vec3(0.0);
  return albedo / pi * incoming * cosine / density;
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
