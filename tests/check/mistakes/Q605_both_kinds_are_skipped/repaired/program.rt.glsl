struct RayPayloadType { vec3 rgb; };

const uint noBoxes = gl_RayFlagsSkipAABBEXT;
const uint noTriangles = gl_RayFlagsSkipTrianglesEXT;

void main() { /**** RAY GENERATION SHADER ****/
  vec2 st = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy);
  uint what = noBoxes;
  traceRayEXT(topLevelAS, what, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 3.0), 0.001, normalize(vec3(st - 0.5, -1.0)), 99.0, 0);
  gsnSetPixel(vec4(payload.rgb, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.rgb = vec3(0.2, 0.7, 0.3);
}

void main() { /**** MISS SHADER ****/
  payload.rgb = vec3(0.0, 0.0, 0.1);
}
