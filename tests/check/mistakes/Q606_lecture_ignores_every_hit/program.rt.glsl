/**** COMMON START ****/
struct RayPayloadType {
  vec3 color;
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 point = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 direction = normalize(vec3(point, -2.0));
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0.0, 0.0, 6.0), 0.001, direction, 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(baryCoord, 1.0);
}

void main() { /**** ANY-HIT SHADER ****/
  float hole = fract(8.0 * baryCoord.x);
  // EXPECT+1 Q606
  ignoreIntersectionEXT;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
