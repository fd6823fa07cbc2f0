struct RayPayloadType { vec3 color; };

#define NUM_LIGHTS 3
const vec3 lights[NUM_LIGHTS] = vec3[](vec3(1, 4, 0), vec3(-3, 2, 2), vec3(0, 5, -4));

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 p = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  float E = 0.0;
  for (int i = 0; i <= NUM_LIGHTS; i++) {
    vec3 d = lights[i] - p;  // EXPECT Q711
    E += 1.0 / dot(d, d);
  }
  payload.color = vec3(3.0 * E);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
