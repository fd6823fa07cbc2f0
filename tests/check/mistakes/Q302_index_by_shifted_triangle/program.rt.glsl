/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct CallableDataType { vec3 color; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  // Three materials; & 3 has four values.
  uint material = uint(gl_PrimitiveID) >> 2 & 3u;
  executeCallableEXT(material, 0);  // EXPECT Q302
  payload.color = callableData.color;
}

void main() { /**** CALLABLE SHADER ****/ callableData.color = vec3(1.0, 0.0, 0.0); }
void main() { /**** CALLABLE SHADER ****/ callableData.color = vec3(0.0, 1.0, 0.0); }
void main() { /**** CALLABLE SHADER ****/ callableData.color = vec3(0.0, 0.0, 1.0); }

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
