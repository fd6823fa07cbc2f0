#define TRACE(o, d, n, f) traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, o, n, d, f, 0)
#define HITPOS (gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT)
#define WORLD_NORMAL(n) normalize(vec3((n) * gl_WorldToObjectEXT))
#define LERP3(a, b, c) ((a) * (1.0 - baryCoord.x - baryCoord.y) + (b) * baryCoord.x + (c) * baryCoord.y)

struct RayPayloadType { vec3 col; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  TRACE(vec3(0.0, 0.0, 6.0), normalize(vec3(ndc, -2.0)), 0.001, 1000.0);
  gsnSetPixel(vec4(payload.col, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 x, y, z;
  gsnGetNormals(gl_InstanceID, gl_PrimitiveID, x, y, z);
  vec3 n = WORLD_NORMAL(LERP3(x, y, z));
  payload.col = (0.5 + 0.5 * n) * fract(HITPOS.y + 10.0);
}

void main() { /**** MISS SHADER ****/
  payload.col = vec3(0.0);
}
