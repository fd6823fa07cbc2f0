/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct CallableDataType {
  vec3 uvw;     // in
  float scale;  // in
  vec3 result;  // out
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 1, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  callableData.uvw = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  callableData.scale = 4.0;
  executeCallableEXT(0u, 0);
  payload.color = callableData.result;
}

void main() { /**** CALLABLE SHADER ****/
  ivec3 cell = ivec3(floor(callableData.uvw * callableData.scale));
  callableData.result = vec3(float((cell.x ^ cell.y ^ cell.z) & 1));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.1);
}
