struct RayPayloadType {
  vec3 radiance;
  vec3 weight;
  vec3 origin;
  vec3 direction;
  uint seed;
  bool ended;
};

float random(inout uint s) {
  s = s * 1664525u + 1013904223u;
  return float(s >> 8) / 16777216.0;
}

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.seed = gl_LaunchIDEXT.x * 1973u + gl_LaunchIDEXT.y * 9277u + uint(frameID) * 26699u;
  payload.radiance = vec3(0.0);
  payload.weight = vec3(1.0);
  payload.origin = vec3(0.0, 0.0, 6.0);
  payload.direction = normalize(vec3(ndc, -2.0));
  payload.ended = false;
  for (int i = 0; i < 6 && !payload.ended; ++i)
    traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, payload.origin, 0.001, payload.direction, 1e4, 0);
  vec4 mean = gsnGetPreviousPixel();
  gsnSetPixel(mean + (vec4(payload.radiance, 1.0) - mean) / float(frameID + 1));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.origin = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  float z = 2.0 * random(payload.seed) - 1.0;
  float a = 6.2831853 * random(payload.seed);
  payload.direction = vec3(sqrt(max(0.0, 1.0 - z * z)) * vec2(cos(a), sin(a)), z);
  payload.weight *= 0.7;
}

void main() { /**** MISS SHADER ****/
  payload.radiance = payload.weight * vec3(0.7, 0.8, 1.0);
  payload.ended = true;
}
