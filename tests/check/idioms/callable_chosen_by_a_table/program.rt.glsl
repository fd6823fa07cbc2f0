/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct CallableDataType { vec3 position; vec3 color; };
const uint materialOfPrimitive[4] = uint[](0u, 2u, 1u, 2u);
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  callableData = CallableDataType(gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT, vec3(0.0));
  executeCallableEXT(materialOfPrimitive[gl_PrimitiveID & 3], 0);
  vec3 first = callableData.color;
  executeCallableEXT(min(uint(gl_InstanceCustomIndexEXT), 2u), 0);
  payload.color = mix(first, callableData.color, 0.5);
}

void main() { /**** CALLABLE SHADER ****/ callableData.color = fract(callableData.position); }
void main() { /**** CALLABLE SHADER ****/ callableData.color = vec3(0.7, 0.2, 0.1); }
void main() { /**** CALLABLE SHADER ****/
  if (callableData.position.y > 0.0) { callableData.color = vec3(1.0); return; }
  callableData.color = vec3(0.2);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
