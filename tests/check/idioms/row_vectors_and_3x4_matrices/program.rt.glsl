struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 a, b, c, na, nb, nc;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, a, b, c);
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, na, nb, nc);
  vec3 w = vec3(1.0 - baryCoord.x - baryCoord.y, baryCoord);
  vec3 position = vec4(mat3(a, b, c) * w, 1.0) * gl_ObjectToWorld3x4EXT;
  vec3 normal = normalize((mat3(na, nb, nc) * w) * mat3(gl_WorldToObjectEXT));
  payload.color = 0.5 + 0.25 * normal + 0.25 * sin(position);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
