// SPDX-License-Identifier: Apache-2.0
// Lesson 04: diffuse light. One lamp lights each surface by Lambert's cosine law, plus an ambient term, without
// shadows.
// scene: diffuse.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};

uniform vec3 lightPosition; // defaultval="3, 5, 3" unit="m" help="Position of the lamp"
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
  vec3 toLight = normalize(lightPosition - position);
  payload.color = ambientColor + baseColor * max(dot(normal, toLight), 0.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = background;
}
