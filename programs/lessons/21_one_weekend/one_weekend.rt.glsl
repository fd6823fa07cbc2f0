// SPDX-License-Identifier: Apache-2.0
// Lesson 21: the final scene of "Ray Tracing in One Weekend" (Shirley 2016): random diffuse, metal and glass spheres
// with depth of field, in four shaders. Each frame takes 8 samples per pixel with at most 16 bounces and is averaged
// with the frames before.
// scene: one_weekend.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  float t;        // negative if the ray misses
  vec3 normal;    // outward, unit, world space
  int sphere;     // index
};
struct HitAttributeType {
  vec3 normal;
};

uniform int samples;       // defaultval="8" min="1" max="64" help="Samples per pixel and frame"
uniform int bounces;       // defaultval="16" min="1" max="64" help="Maximum number of bounces of a path"
uniform float aperture;    // defaultval="0.1" min="0" max="2" unit="m" help="Diameter of the lens"
uniform float focus;       // defaultval="10" min="0.1" max="1000" unit="m" help="Distance that is in focus"
/**** COMMON END ****/

const float pi = 3.14159265359;

// PCG (O'Neill 2014; Jarzynski and Olano 2020). Each path has its own state, seeded from pixel and sample.
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
vec3 randomUnit() {
  float z = 1.0 - 2.0 * random();
  float angle = 2.0 * pi * random();
  return vec3(sqrt(max(0.0, 1.0 - z * z)) * vec2(cos(angle), sin(angle)), z);
}

// The material of sphere i: 0 is the ground, 1 to 3 are the large spheres (glass, diffuse, metal), all others are
// random.
const int diffuse = 0;
const int metal = 1;
const int glass = 2;
struct Material {
  int kind;
  vec3 color;
  float fuzz;
};
Material materialOf(int i) {
  if (i == 0) return Material(diffuse, vec3(0.5), 0.0);
  if (i == 1) return Material(glass, vec3(1.0), 0.0);
  if (i == 2) return Material(diffuse, vec3(0.4, 0.2, 0.1), 0.0);
  if (i == 3) return Material(metal, vec3(0.7, 0.6, 0.5), 0.0);
  uint h = hash(uint(i));
  vec3 a = vec3(h & 1023u, (h >> 10u) & 1023u, (h >> 20u) & 1023u) / 1023.0;
  h = hash(h);
  vec3 b = vec3(h & 1023u, (h >> 10u) & 1023u, (h >> 20u) & 1023u) / 1023.0;
  float choice = float(hash(h + 1u) >> 8u) / 16777216.0;
  if (choice < 0.8) return Material(diffuse, a * b, 0.0);
  if (choice < 0.95) return Material(metal, 0.5 + 0.5 * a, 0.5 * b.x);
  return Material(glass, vec3(1.0), 0.0);
}

// Schlick's approximation of the Fresnel reflectance.
float reflectance(float cosine, float eta) {
  float r0 = (1.0 - eta) / (1.0 + eta);
  r0 *= r0;
  return r0 + (1.0 - r0) * pow(1.0 - cosine, 5.0);
}

// Computes the next direction of the path; returns false if the path is absorbed.
bool scatter(Material m, vec3 incoming, vec3 outward, out vec3 direction) {
  bool front = dot(incoming, outward) < 0.0;
  vec3 normal = front ? outward : -outward;
  if (m.kind == diffuse) {
    direction = normal + randomUnit();
    if (dot(direction, direction) < 1e-12) direction = normal;
    return true;
  }
  if (m.kind == metal) {
    direction = normalize(reflect(incoming, normal)) + m.fuzz * randomUnit();
    return dot(direction, normal) > 0.0;
  }
  float eta = front ? 1.0 / 1.5 : 1.5;
  float cosine = min(dot(-incoming, normal), 1.0);
  direction = refract(incoming, normal, eta);
  if (direction == vec3(0.0) || reflectance(cosine, eta) > random()) direction = reflect(incoming, normal);
  return true;
}

vec3 pathColor(vec3 origin, vec3 direction) {
  vec3 weight = vec3(1.0);
  for (int bounce = 0; bounce <= bounces; ++bounce) {
    traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, 0xFFu, 0u, 0u, 0u, origin, 0.0, direction, 1e4, 0);
    if (payload.t < 0.0) {
      float up = 0.5 + 0.5 * direction.y;
      return weight * mix(vec3(1.0), vec3(0.5, 0.7, 1.0), up);
    }
    vec3 position = origin + payload.t * direction;
    vec3 normal = payload.normal;
    vec3 next;
    Material m = materialOf(payload.sphere);
    if (!scatter(m, direction, normal, next)) return vec3(0.0);
    weight *= m.color;
    direction = normalize(next);
    // Offset from the surface, to the side of the new ray.
    origin = position + (dot(direction, normal) > 0.0 ? 1e-3 : -1e-3) * normal;
  }
  return vec3(0.0);
}

void main() { /**** RAY GENERATION SHADER ****/
  vec3 eye = vec3(13.0, 2.0, 3.0);
  vec3 back = normalize(eye);
  vec3 right = normalize(cross(vec3(0.0, 1.0, 0.0), back));
  vec3 up = cross(back, right);
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  uint pixel = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;

  vec3 sum = vec3(0.0);
  for (int s = 0; s < samples; ++s) {
    randomState = hash(pixel ^ hash(uint(frameID * samples + s)));
    vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + vec2(random(), random())) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
    vec2 plane = ndc * vec2(aspect, 1.0) * tan(0.5 * radians(20.0));
    float angle = 2.0 * pi * random();
    vec2 lens = 0.5 * aperture * sqrt(random()) * vec2(cos(angle), sin(angle));
    vec3 origin = eye + lens.x * right + lens.y * up;
    vec3 target = eye + focus * (plane.x * right + plane.y * up - back);
    sum += pathColor(origin, normalize(target - origin));
  }
  // Averaged in linear values, stored with gamma 2 as in the book.
  vec3 before = gsnGetPreviousPixel().rgb;
  vec3 linear = (before * before * float(frameID) + sum / float(samples)) / float(frameID + 1);
  gsnSetPixel(vec4(sqrt(linear), 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 boxMin, boxMax;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, boxMin, boxMax);
  vec3 o = gl_ObjectRayOriginEXT - 0.5 * (boxMin + boxMax);
  vec3 d = gl_ObjectRayDirectionEXT;
  float radius = 0.5 * (boxMax.x - boxMin.x);
  float a = dot(d, d);
  float b = dot(o, d);
  vec3 nearest = o - (b / a) * d;
  float discriminant = a * (radius * radius - dot(nearest, nearest));
  if (discriminant < 0.0) return;
  float q = sqrt(discriminant);
  float t = (-b - q) / a;
  if (t < gl_RayTminEXT) t = (-b + q) / a;
  if (t < gl_RayTminEXT || t > gl_RayTmaxEXT) return;
  hit.normal = (o + t * d) / radius;
  reportIntersectionEXT(t, 0u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.t = gl_HitTEXT;
  payload.normal = hit.normal;
  payload.sphere = gl_PrimitiveID;
}

void main() { /**** MISS SHADER ****/
  payload.t = -1.0;
  payload.normal = vec3(0.0);
  payload.sphere = -1;
}
