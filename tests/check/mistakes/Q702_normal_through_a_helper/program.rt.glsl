/**** COMMON START ****/
struct RayPayloadType { vec3 color; };

vec3 worldVector(vec3 v) { return normalize(gl_ObjectToWorldEXT * vec4(v, 0.0)); }  // EXPECT Q702
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 1e-3, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 a, b, c;
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, a, b, c);
  vec3 x = (1.0 - baryCoord.x - baryCoord.y) * a + baryCoord.x * b + baryCoord.y * c;
  vec3 y = worldVector(x);
  payload.color = vec3(0.1) + 0.9 * max(dot(y, vec3(0.0, 0.8, 0.6)), 0.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.05, 0.05, 0.1);
}
