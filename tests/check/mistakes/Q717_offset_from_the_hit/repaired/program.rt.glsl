struct RayPayloadType { vec3 color; float dist; vec3 n; };

uint state;
float rnd() { state = state * 747796405u + 2891336453u; return float(state >> 8) / 16777216.0; }

void main() { /**** RAY GENERATION SHADER ****/
  state = gl_LaunchIDEXT.x * 9781u + gl_LaunchIDEXT.y * 6271u + uint(frameID) * 26699u;
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 o = vec3(0.0, 0.0, 6.0), d = normalize(vec3(ndc, -2.0));
  vec3 weight = vec3(1.0), sum = vec3(0.0);
  for (int i = 0; i < 4; ++i) {
    traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, o, 0.001, d, 1e4, 0);
    if (payload.dist < 0.0) { sum = weight * payload.color; break; }
    weight *= payload.color;
    o = o + d * payload.dist;
    float z = 1.0 - 2.0 * rnd(), a = 6.2831853 * rnd();
    d = normalize(payload.n) + vec3(sqrt(1.0 - z * z) * vec2(cos(a), sin(a)), z);
  }
  gsnSetPixel(mix(gsnGetPreviousPixel(), vec4(sum, 1.0), 1.0 / float(frameID + 1)));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(0.7);
  payload.n = -gl_WorldRayDirectionEXT;
  payload.dist = gl_HitTEXT;
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.6, 0.8, 1.0);
  payload.n = vec3(0.0, 1.0, 0.0);
  payload.dist = -1.0;
}
