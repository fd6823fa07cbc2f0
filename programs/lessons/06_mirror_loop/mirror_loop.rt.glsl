// SPDX-License-Identifier: Apache-2.0
// Lesson 06: reflection as a loop. The closest-hit shader returns the direct light of the surface and the reflected
// ray. The ray generation shader traces five rays at most and stops when the remaining weight is negligible.
// scene: mirror_loop.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 directLight;      // of this surface
  vec3 nextOrigin;
  vec3 nextDirection;    // zero if the path ends here
  float reflectance;     // weight of the next ray
  bool lampIsSeen;
};

uniform vec3 lampPosition;  // defaultval="3, 5, 3" unit="m" help="Position of the lamp"
uniform vec3 ambientColor;  // defaultval="0.1, 0.1, 0.12" type="color" help="Ambient light"
uniform vec3 background;    // defaultval="0.3, 0.35, 0.45" type="color" help="Color of the background"
uniform float reflectance;  // defaultval="0.4" min="0" max="1" help="Reflectance of all surfaces"
uniform int maxLevel;       // defaultval="5" min="1" max="16" help="Maximum number of rays of a path, without shadow rays"

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
  vec3 origin = vec3(2.0, 3.0, 6.0);
  vec3 direction = lookAtDirection(point, origin, vec3(0.0, 0.7, 0.0), 35.0, aspect);

  vec3 color = vec3(0.0);
  float contribution = 1.0;
  for (int level = 0; level < maxLevel && contribution > smallestContribution; ++level) {
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, origin, 0.0, direction, 1000.0, 0);
    color += contribution * payload.directLight;
    if (payload.nextDirection == vec3(0.0)) break;
    contribution *= payload.reflectance;
    origin = payload.nextOrigin;
    direction = payload.nextDirection;
  }
  gsnSetPixel(vec4(color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 n0, n1, n2;
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n0, n1, n2);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * (n0 * (1.0 - baryCoord.x - baryCoord.y) + n1 * baryCoord.x + n2 * baryCoord.y));
  if (dot(normal, gl_WorldRayDirectionEXT) > 0.0) normal = -normal;
  vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + bias * normal;
  vec3 base = baseColorOf(gl_InstanceID);

  vec3 toLamp = lampPosition - position;
  float lampDistance = length(toLamp);
  payload.lampIsSeen = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              position, 0.0, toLamp / lampDistance, lampDistance, 0);

  vec3 light = ambientColor;
  if (payload.lampIsSeen) light += vec3(max(dot(normal, toLamp / lampDistance), 0.0));
  payload.directLight = base * light;
  payload.nextOrigin = position;
  payload.nextDirection = reflect(gl_WorldRayDirectionEXT, normal);
  payload.reflectance = reflectance;
}

void main() { /**** MISS SHADER ****/
  payload.directLight = background;
  payload.nextOrigin = vec3(0.0);
  payload.nextDirection = vec3(0.0);
  payload.reflectance = 0.0;
  payload.lampIsSeen = true;
}
