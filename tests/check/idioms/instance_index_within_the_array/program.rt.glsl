struct RayPayloadType { vec3 color; };
const vec3 palette[3] = vec3[](vec3(0.9, 0.2, 0.1), vec3(0.1, 0.3, 0.9), vec3(0.2));

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = palette[min(gl_InstanceID, 2)] * (gl_InstanceCustomIndexEXT == 4 ? 0.5 : 1.0);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
