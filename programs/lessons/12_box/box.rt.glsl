// SPDX-License-Identifier: Apache-2.0
// Lesson 12: a box from three slabs. Each pair of parallel faces bounds a slab; the ray is inside the box where it is
// inside all three slabs (Kay and Kajiya 1986).
// scene: box.scene.toml
/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};
struct HitAttributeType {
  vec3 normal;    // of the face, outward, object space
  vec2 texCoord;  // on the face, [0, 1]
};

uniform int show;   // defaultval="0" min="0" max="2" help="Quantity to show: 0 shaded, 1 normal, 2 texture coordinate"
uniform vec3 eye;   // defaultval="0, 0.5, 6" unit="m" help="Position of the camera, which looks along -z"
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  float aspect = float(gl_LaunchSizeEXT.x) / float(gl_LaunchSizeEXT.y);
  vec3 direction = normalize(vec3(ndc * vec2(aspect, 1.0) * tan(0.5 * radians(40.0)), -1.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, eye, 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 a, b;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, a, b);

  // Parameters t at the six planes. A direction parallel to a slab gives infinities, which compare correctly.
  vec3 inverse = 1.0 / gl_ObjectRayDirectionEXT;
  vec3 ta = (a - gl_ObjectRayOriginEXT) * inverse;
  vec3 tb = (b - gl_ObjectRayOriginEXT) * inverse;
  vec3 first = min(ta, tb);
  vec3 last = max(ta, tb);
  float tIn = max(first.x, max(first.y, first.z));
  float tOut = min(last.x, min(last.y, last.z));
  if (!(tIn <= tOut)) return;

  bool entering = tIn >= gl_RayTminEXT;  // otherwise the ray starts inside
  float t = entering ? tIn : tOut;
  if (t < gl_RayTminEXT || t > gl_RayTmaxEXT) return;

  // The hit face is the one whose plane has this t.
  vec3 planes = entering ? first : last;
  int axis = planes.x == t ? 0 : planes.y == t ? 1 : 2;
  vec3 normal = vec3(0.0);
  normal[axis] = (gl_ObjectRayDirectionEXT[axis] > 0.0) == entering ? -1.0 : 1.0;

  // Position in the box, [0, 1] on each axis. Seen from outside, s increases to the right and t upwards.
  vec3 p = (gl_ObjectRayOriginEXT + t * gl_ObjectRayDirectionEXT - a) / (b - a);
  if (axis == 0) hit.texCoord = vec2(normal.x > 0.0 ? 1.0 - p.z : p.z, p.y);
  else if (axis == 1) hit.texCoord = vec2(p.x, normal.y > 0.0 ? 1.0 - p.z : p.z);
  else hit.texCoord = vec2(normal.z > 0.0 ? p.x : 1.0 - p.x, p.y);
  hit.normal = normal;
  reportIntersectionEXT(t, entering ? 1u : 2u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  mat3 normalMatrix;
  gsnGetNormal3x3Matrix(gl_InstanceID, normalMatrix);
  vec3 normal = normalize(normalMatrix * hit.normal);
  if (show == 1) payload.color = 0.5 + 0.5 * normal;
  else if (show == 2) payload.color = vec3(hit.texCoord, 0.0);
  else {
    bool dark = ((int(6.0 * hit.texCoord.x) + int(6.0 * hit.texCoord.y)) & 1) != 0;
    payload.color = (dark ? vec3(0.45, 0.2, 0.15) : vec3(0.9, 0.8, 0.65)) * (0.2 + 0.8 * abs(dot(normal, normalize(vec3(1.0, 2.0, 3.0)))));
  }
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.1, 0.12, 0.16);
}
