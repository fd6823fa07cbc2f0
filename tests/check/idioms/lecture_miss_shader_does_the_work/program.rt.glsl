/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 direction = normalize(vec3(point, -2.0));
  payload.color = vec3(0.0);
  traceRayEXT(topLevelAS, gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** MISS SHADER ****/
  payload.color = abs(gl_WorldRayDirectionEXT);
}
