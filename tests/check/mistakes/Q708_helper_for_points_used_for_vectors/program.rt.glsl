/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
vec3 toWorld(vec3 p) { return gl_ObjectToWorldEXT * vec4(p, 1.0); }  // EXPECT Q708
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 1e-3, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p[3];
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, p[0], p[1], p[2]);
  vec3 e1 = toWorld(p[1] - p[0]);
  vec3 e2 = toWorld(p[2] - p[0]);
  payload.color = 0.5 + 0.5 * normalize(cross(e1, e2));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.05, 0.05, 0.1);
}
