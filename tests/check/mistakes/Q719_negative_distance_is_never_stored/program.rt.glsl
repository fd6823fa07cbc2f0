struct RayPayloadType { float hitT; };

float shade(float t) { return t == -1.0 ? 0.0 : exp(-0.2 * t); }

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.hitT = -1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 50.0, 0);
  gsnSetPixel(vec4(vec3(shade(payload.hitT)), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.hitT = gl_HitTEXT; }
void main() { /**** MISS SHADER ****/
  payload.hitT = gl_RayTmaxEXT;  // EXPECT Q719
}
