// SPDX-License-Identifier: Apache-2.0
// Lesson 15: the any-hit shader. It runs for every candidate hit and can ignore it, so camera rays and shadow rays pass
// through the holes in the plates. Mode 1 ignores all candidates and counts them; mode 2 ends the search at the first
// candidate found, which is not necessarily the nearest.
// scene: any_hit.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
  bool lampIsSeen;
  int layers;  // number of candidates
};

uniform int mode;          // defaultval="0" min="0" max="2" help="Mode: 0 holes, 1 count the layers without holes, 2 end at the first candidate"
uniform float holeRadius;  // defaultval="0.35" min="0" max="0.5" help="Radius of the holes, in texture coordinates of a grid cell"

bool inHole(vec2 texCoord) {
  vec2 field = fract(texCoord * 4.0) - 0.5;
  return dot(field, field) < holeRadius * holeRadius;
}
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 eye = vec3(0.0, 2.5, 6.0);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(40.0)) - vec2(0.0, 0.2), -1.0));
  payload.layers = 0;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, 0.001, direction, 1000.0, 0);
  vec3 color = mode == 1 ? vec3(float(payload.layers) / 4.0) : payload.color;
  gsnSetPixel(vec4(color, 1.0));
}

void main() { /**** ANY-HIT SHADER ****/
  vec2 t0, t1, t2;
  gsnGetTexCoords(gl_InstanceID, gl_PrimitiveID, t0, t1, t2);
  vec2 texCoord = t0 * (1.0 - baryCoord.x - baryCoord.y) + t1 * baryCoord.x + t2 * baryCoord.y;
  if (mode == 0 && gl_InstanceID > 0 && inHole(texCoord)) ignoreIntersectionEXT;
  if (mode == 1) {
    // Payload writes before this statement stay; nothing after it runs.
    payload.layers++;
    ignoreIntersectionEXT;
  }
  if (mode == 2) terminateRayEXT;
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * cross(p1 - p0, p2 - p0));
  if (dot(normal, gl_WorldRayDirectionEXT) > 0.0) normal = -normal;
  vec3 base = gl_InstanceID == 0 ? vec3(0.7, 0.7, 0.65) : gl_InstanceID == 1 ? vec3(0.8, 0.4, 0.2) : vec3(0.25, 0.45, 0.7);
  vec3 position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + 0.001 * normal;
  if (mode != 0) {
    payload.color = base;
    return;
  }
  vec3 toLamp = vec3(2.0, 5.0, 4.0) - position;
  float lampDistance = length(toLamp);
  payload.lampIsSeen = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              position, 0.0, toLamp / lampDistance, lampDistance, 0);
  float light = payload.lampIsSeen ? max(dot(normal, toLamp / lampDistance), 0.0) : 0.0;
  payload.color = base * (0.15 + 0.85 * light);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.35, 0.45, 0.6);
  payload.lampIsSeen = true;
}
