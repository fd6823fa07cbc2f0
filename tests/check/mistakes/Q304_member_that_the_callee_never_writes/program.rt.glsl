/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct CallableDataType { vec2 uv; vec3 albedo; float roughness; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  callableData.uv = baryCoord;
  executeCallableEXT(0u, 0);  // EXPECT Q304
  float gloss = 1.0 - callableData.roughness;
  payload.color = callableData.albedo + 0.2 * gloss;
}

void main() { /**** CALLABLE SHADER ****/
  callableData.albedo = mix(vec3(0.2, 0.1, 0.0), vec3(0.7, 0.5, 0.3), fract(9.0 * callableData.uv.x));
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
