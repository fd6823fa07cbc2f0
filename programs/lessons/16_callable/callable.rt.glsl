// SPDX-License-Identifier: Apache-2.0
// Lesson 16: callable shaders. Each material is a callable shader, selected by an index at run time: the closest-hit
// shader passes position and normal to material number gl_InstanceID.
// scene: callable.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};
struct CallableDataType {
  vec3 position;  // in: point on the surface, world space
  vec3 normal;    // in: unit, world space
  vec3 color;     // out
};

const vec3 toLight = vec3(0.4, 0.8, 0.45);
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(35.0)), -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 7.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 n0, n1, n2;
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n0, n1, n2);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  callableData.normal = normalize(normalMatrix * (n0 * (1.0 - baryCoord.x - baryCoord.y) + n1 * baryCoord.x + n2 * baryCoord.y));
  callableData.position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  executeCallableEXT(uint(gl_InstanceID), 0);
  payload.color = callableData.color;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.08, 0.09, 0.12);
}

// 0: diffuse.
void main() { /**** CALLABLE SHADER ****/
  callableData.color = vec3(0.8, 0.3, 0.2) * max(dot(callableData.normal, normalize(toLight)), 0.0);
}

// 1: a checkerboard in 3D.
void main() { /**** CALLABLE SHADER ****/
  ivec3 cell = ivec3(floor(callableData.position * 3.0));
  vec3 base = ((cell.x + cell.y + cell.z) & 1) != 0 ? vec3(0.9) : vec3(0.1, 0.2, 0.3);
  callableData.color = base * (0.3 + 0.7 * max(dot(callableData.normal, normalize(toLight)), 0.0));
}

// 2: three tones, as in a comic.
void main() { /**** CALLABLE SHADER ****/
  float light = dot(callableData.normal, normalize(toLight));
  callableData.color = vec3(0.3, 0.6, 0.9) * (light > 0.7 ? 1.0 : light > 0.2 ? 0.6 : 0.3);
}
