/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 1e-3, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 a, b, c;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, a, b, c);
  vec3 pos = a * (1.0 - baryCoord.x - baryCoord.y) + b * baryCoord.x + c * baryCoord.y;
  vec3 worldPos = gl_ObjectToWorldEXT * vec4(pos, 1.0);
  payload.color = fract(worldPos);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
