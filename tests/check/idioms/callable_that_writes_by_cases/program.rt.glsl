/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct CallableDataType { int pattern; vec2 uv; vec3 color; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  callableData.pattern = gl_PrimitiveID % 3;
  callableData.uv = baryCoord;
  executeCallableEXT(0u, 0);
  payload.color = callableData.color;
}

void main() { /**** CALLABLE SHADER ****/
  switch (callableData.pattern) {
    case 0: callableData.color = vec3(step(0.5, fract(8.0 * callableData.uv)), 0.0); break;
    case 1: callableData.color.r = 1.0; callableData.color.gb = callableData.uv; break;
    default: callableData.color = vec3(0.3);
  }
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
