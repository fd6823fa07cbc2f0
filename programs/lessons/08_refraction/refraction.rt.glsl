// SPDX-License-Identifier: Apache-2.0
// Lesson 08: refraction. Rays change direction where they enter and leave a sphere (Snell's law) and are reflected
// inside where they cannot leave (total internal reflection). The two media are `inside` and `outside` the sphere. With
// `fresnel`, a ray is reflected at random with the probability of the Fresnel equations, and frames are averaged.
// scene: refraction.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;          // color at the end of the path
  vec3 nextOrigin;
  vec3 nextDirection;  // zero if the path ends here
  uint randomState;    // of the path
};
struct HitAttributeType {
  vec3 normal;         // outward, object space
};

uniform float inside;   // defaultval="1.5" min="1" max="3" help="Index of refraction of the sphere"
uniform float outside;  // defaultval="1.0" min="1" max="3" help="Index of refraction of the surroundings"
uniform int maxLevel;   // defaultval="8" min="1" max="32" help="Maximum number of rays of a path"
uniform bool fresnel;   // defaultval="false" help="Reflect a part of the light at every angle, at random; needs several frames"

const uint kindEntering = 1u;
const uint kindLeaving = 2u;

uint hash(uint x) {
  x = x * 747796405u + 2891336453u;
  x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
  return (x >> 22u) ^ x;
}
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 origin = vec3(0.0, 1.5, 6.0);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(35.0)), -1.0));
  uint pixel = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x;
  payload.randomState = hash(pixel ^ hash(uint(frameID)));
  vec3 color = vec3(0.0);
  for (int level = 0; level < maxLevel; ++level) {
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, origin, 0.0, direction, 1000.0, 0);
    color = payload.color;
    if (payload.nextDirection == vec3(0.0)) break;
    origin = payload.nextOrigin;
    direction = payload.nextDirection;
  }
  vec3 mean = gsnGetPreviousPixel().rgb;
  gsnSetPixel(vec4(mean + (color - mean) / float(frameID + 1), 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 boxMin, boxMax;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, boxMin, boxMax);
  vec3 center = 0.5 * (boxMin + boxMax);
  float radius = 0.5 * (boxMax.x - boxMin.x);

  // |o + t d|² = r² in object space. The direction is not normalized, so t is the same as in world space.
  vec3 o = gl_ObjectRayOriginEXT - center;
  vec3 d = gl_ObjectRayDirectionEXT;
  float a = dot(d, d);
  float b = dot(o, d);
  vec3 nearest = o - (b / a) * d;  // point of the ray closest to the center; keeps rounding errors small
  float discriminant = a * (radius * radius - dot(nearest, nearest));
  if (discriminant < 0.0) return;
  float q = sqrt(discriminant);
  float tIn = (-b - q) / a;
  float tOut = (-b + q) / a;
  float t = tIn >= gl_RayTminEXT ? tIn : tOut;
  if (t < gl_RayTminEXT || t > gl_RayTmaxEXT) return;
  hit.normal = (o + t * d) / radius;
  reportIntersectionEXT(t, t == tIn ? kindEntering : kindLeaving);
}

// Returns the fraction of unpolarized light that a smooth surface reflects (Fresnel 1823). `eta` is n1 / n2.
float reflectedFraction(float cosIn, float eta) {
  float cosOut = sqrt(max(0.0, 1.0 - eta * eta * (1.0 - cosIn * cosIn)));
  float perpendicular = (eta * cosIn - cosOut) / (eta * cosIn + cosOut);
  float parallel = (cosIn - eta * cosOut) / (cosIn + eta * cosOut);
  return 0.5 * (perpendicular * perpendicular + parallel * parallel);
}

float random() {
  payload.randomState = payload.randomState * 747796405u + 2891336453u;
  return float(hash(payload.randomState) >> 8u) / 16777216.0;
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  if (gl_HitKindEXT == gl_HitKindFrontFacingTriangleEXT || gl_HitKindEXT == gl_HitKindBackFacingTriangleEXT) {
    // The floor: a checkerboard with squares of 0.5 m.
    bool dark = (int(floor(2.0 * position.x)) + int(floor(2.0 * position.z)) & 1) != 0;
    payload.color = dark ? vec3(0.1, 0.15, 0.2) : vec3(0.85, 0.8, 0.7);
    payload.nextDirection = vec3(0.0);
    return;
  }
  vec3 direction = normalize(gl_WorldRayDirectionEXT);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * hit.normal);
  bool entering = gl_HitKindEXT == kindEntering;
  if (!entering) normal = -normal;

  // Snell's law: sin(refracted) = eta · sin(incoming). refract() returns zero if there is no solution.
  float eta = entering ? outside / inside : inside / outside;
  vec3 next = refract(direction, normal, eta);
  bool reflected = next == vec3(0.0);
  if (!reflected && fresnel) reflected = random() < reflectedFraction(-dot(direction, normal), eta);
  if (reflected) next = reflect(direction, normal);
  payload.color = vec3(0.0);  // used if the path is cut off here
  payload.nextOrigin = position + (reflected ? 1e-4 : -1e-4) * normal;
  payload.nextDirection = next;
}

void main() { /**** MISS SHADER ****/
  float height = 0.5 + 0.5 * normalize(gl_WorldRayDirectionEXT).y;
  payload.color = mix(vec3(0.9, 0.75, 0.6), vec3(0.25, 0.45, 0.8), height);
  payload.nextDirection = vec3(0.0);
}
