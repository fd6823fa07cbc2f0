// SPDX-License-Identifier: Apache-2.0
// Lesson 19: a scene that moves. The BLASes stay the same; the TLAS is rebuilt for each frame from the new transforms.
// The shaders need no changes: they read the matrices of the current frame.
// scene: dynamic.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
  bool sunIsSeen;
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(40.0)) - vec2(0.0, 0.35), -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 3.5, 8.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p0, p1, p2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * cross(p1 - p0, p2 - p0));
  vec3 base = gl_InstanceID == 0 ? vec3(0.6, 0.62, 0.6) : gl_InstanceID == 1 ? vec3(0.85, 0.45, 0.2) : vec3(0.2, 0.5, 0.75);
  vec3 toSun = normalize(vec3(0.5, 1.0, 0.4));
  payload.sunIsSeen = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT + 0.001 * normal, 0.0, toSun, 1000.0, 0);
  float light = payload.sunIsSeen ? max(dot(normal, toSun), 0.0) : 0.0;
  payload.color = base * (0.2 + 0.8 * light);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.6, 0.72, 0.85);
  payload.sunIsSeen = true;
}
