// SPDX-License-Identifier: Apache-2.0
// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 6"
// Lesson 07: reflection by recursion. The image of lesson 06, but the closest-hit shader traces the reflected ray
// itself and adds its color. The payload carries the level down and the color up. Nested shaders write the same
// payload, so a shader must copy what it needs after a nested trace to local variables.
// scene: mirror_recursion.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
  int level;           // of this ray: 0 for a camera ray
  float contribution;  // of this ray to the pixel
  bool lampIsSeen;
};

uniform vec3 lampPosition;  // defaultval="3, 5, 3" unit="m" help="Position of the lamp"
uniform vec3 ambientColor;  // defaultval="0.1, 0.1, 0.12" type="color" help="Ambient light"
uniform vec3 background;    // defaultval="0.3, 0.35, 0.45" type="color" help="Color of the background"
uniform float reflectance;  // defaultval="0.4" min="0" max="1" help="Reflectance of all surfaces"

// The pipeline is created for this depth ("recursion: 6" above: a ray at each of five levels, and the shadow ray of the
// last one), so it cannot be a parameter.
const int maxLevel = 5;
const float smallestContribution = 0.001;
const float bias = 0.001;

// By instance: floor, sphere, cube.
vec3 baseColorOf(int instance) {
  return instance == 0 ? vec3(0.55, 0.55, 0.5) : instance == 1 ? vec3(0.15, 0.3, 0.6) : vec3(0.7, 0.35, 0.1);
}
/**** COMMON END ****/

vec3 lookAtDirection(vec2 point, vec3 eye, vec3 target, float fieldOfView, float aspect) {
  vec3 back = normalize(eye - target);
  vec3 right = normalize(cross(vec3(0.0, 1.0, 0.0), back));
  vec2 plane = (2.0 * point - 1.0) * vec2(aspect, 1.0) * tan(0.5 * radians(fieldOfView));
  return normalize(plane.x * right + plane.y * cross(back, right) - back);
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 point = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy);
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 eye = vec3(2.0, 3.0, 6.0);
  payload.level = 0;
  payload.contribution = 1.0;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, 0.0,
              lookAtDirection(point, eye, vec3(0.0, 0.7, 0.0), 35.0, aspect), 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  // Copied, because the nested rays overwrite the payload.
  int level = payload.level;
  float contribution = payload.contribution;
  vec3 incoming = gl_WorldRayDirectionEXT;

  vec3 n0, n1, n2;
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n0, n1, n2);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * (n0 * (1.0 - baryCoord.x - baryCoord.y) + n1 * baryCoord.x + n2 * baryCoord.y));
  if (dot(normal, incoming) > 0.0) normal = -normal;
  vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * incoming + bias * normal;
  vec3 base = baseColorOf(gl_InstanceID);

  vec3 toLamp = lampPosition - position;
  float lampDistance = length(toLamp);
  payload.lampIsSeen = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              position, 0.0, toLamp / lampDistance, lampDistance, 0);
  vec3 light = ambientColor;
  if (payload.lampIsSeen) light += vec3(max(dot(normal, toLamp / lampDistance), 0.0));
  vec3 color = base * light;

  if (level + 1 < maxLevel && contribution * reflectance > smallestContribution) {
    payload.level = level + 1;
    payload.contribution = contribution * reflectance;
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, position, 0.0, reflect(incoming, normal), 1000.0, 0);
    color += reflectance * payload.color;
  }
  payload.color = color;
}

void main() { /**** MISS SHADER ****/
  payload.color = background;
  payload.lampIsSeen = true;
}
