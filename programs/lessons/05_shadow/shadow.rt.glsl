// SPDX-License-Identifier: Apache-2.0
// Lesson 05: shadow. At each surface a second ray tests whether the lamp is visible. It stops at the first hit and runs
// no closest-hit shader; the miss shader reports that the lamp is visible. The lamp circles once in 45 frames.
// scene: shadow.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
  bool lampIsSeen;  // set by the miss shader of the shadow ray
};

const int framesPerTurn = 45;
uniform float lampRadius;   // defaultval="4" min="0.1" max="100" unit="m" help="Radius of the lamp's circle, 5 m above the floor"
uniform vec3 baseColor;     // defaultval="0.8, 0.7, 0.55" type="color" help="Color of all surfaces"
uniform vec3 ambientColor;  // defaultval="0.1, 0.1, 0.12" type="color" help="Ambient light"
uniform vec3 background;    // defaultval="0.3, 0.35, 0.45" type="color" help="Color of the background"
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
  vec3 direction = lookAtDirection(point, eye, vec3(0.0, 0.7, 0.0), 35.0, aspect);
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 n0, n1, n2;
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n0, n1, n2);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * (n0 * (1.0 - baryCoord.x - baryCoord.y) + n1 * baryCoord.x + n2 * baryCoord.y));

  vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  float turn = 2.0 * 3.14159265359 * float(frameID % framesPerTurn) / float(framesPerTurn);
  vec3 lamp = vec3(lampRadius * cos(turn), 5.0, lampRadius * sin(turn));
  vec3 toLamp = lamp - position;
  float lampDistance = length(toLamp);

  // The shadow ray starts slightly above the surface, on the side that the viewer sees, and ends at the lamp.
  vec3 side = dot(normal, gl_WorldRayDirectionEXT) < 0.0 ? normal : -normal;
  payload.lampIsSeen = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              position + 0.001 * side, 0.0, toLamp / lampDistance, lampDistance, 0);

  vec3 radiance = ambientColor;
  if (payload.lampIsSeen) radiance += baseColor * max(dot(normal, toLamp / lampDistance), 0.0);
  payload.color = radiance;
}

void main() { /**** MISS SHADER ****/
  payload.color = background;
  payload.lampIsSeen = true;
}
