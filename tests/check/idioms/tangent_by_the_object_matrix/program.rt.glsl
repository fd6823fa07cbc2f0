// Tangents are directions in the surface: the object-to-world matrix transforms them. Normals need the other one.
struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p[3];
  vec2 t[3];
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p[0], p[1], p[2]);
  gsnGetTexCoords(gl_InstanceID, gl_PrimitiveID, t[0], t[1], t[2]);
  vec3 e1 = p[1] - p[0], e2 = p[2] - p[0];
  vec2 d1 = t[1] - t[0], d2 = t[2] - t[0];
  vec3 tangent = e1 * d2.y - e2 * d1.y;
  vec3 normal = cross(e1, e2);
  vec3 T = normalize(mat3(gl_ObjectToWorldEXT) * tangent);
  vec3 N = normalize(transpose(mat3(gl_WorldToObjectEXT)) * normal);
  payload.color = 0.5 + 0.25 * (cross(N, T) + N);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
