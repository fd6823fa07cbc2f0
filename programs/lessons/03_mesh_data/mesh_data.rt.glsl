// SPDX-License-Identifier: Apache-2.0
// Lesson 03: mesh data at a hit. The built-ins give the instance and the triangle, functions fetch its three vertices,
// and barycentric coordinates interpolate between them.
// scene: mesh_data.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};

uniform int show;         // defaultval="1" min="0" max="4" help="Quantity to show: 0 position, 1 normal, 2 texture coordinate, 3 barycentrics, 4 face normal"
uniform vec3 eye;         // defaultval="0, 1.5, 5" unit="m" help="Position of the camera, which looks along -z"
uniform float fieldOfView; // defaultval="40" min="1" max="179" unit="deg" help="Vertical field of view"
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(fieldOfView)), -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  // The three vertices of the triangle that was hit, in object space.
  vec3 p0, p1, p2, n0, n1, n2;
  vec2 t0, t1, t2;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p0, p1, p2);
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, n0, n1, n2);
  gsnGetTexCoords(gl_InstanceID, gl_PrimitiveID, t0, t1, t2);

  // p = w p0 + u p1 + v p2 with w = 1 - u - v.
  vec3 weights = vec3(1.0 - baryCoord.x - baryCoord.y, baryCoord);
  vec3 localPosition = weights.x * p0 + weights.y * p1 + weights.z * p2;
  vec3 localNormal = weights.x * n0 + weights.y * n1 + weights.z * n2;
  vec2 texCoord = weights.x * t0 + weights.y * t1 + weights.z * t2;

  // The matrix transforms points to world space; its inverse transpose transforms normals. A scaled sphere shows the
  // difference.
  vec3 position = gl_ObjectToWorldEXT * vec4(localPosition, 1.0);
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * localNormal);
  vec3 faceNormal = normalize(normalMatrix * cross(p1 - p0, p2 - p0));

  if (show == 0) payload.color = 0.5 + 0.2 * position;
  else if (show == 1) payload.color = 0.5 + 0.5 * normal;
  else if (show == 2) payload.color = vec3(texCoord, 0.0);
  else if (show == 3) payload.color = weights;
  else payload.color = 0.5 + 0.5 * faceNormal;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
