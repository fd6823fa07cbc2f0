struct RayPayloadType { vec3 color; uint rng; };

uint hash(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  return v.x ^ (v.y >> 16u) ^ v.z;
}
float unit(inout uint s) { s = s * 747796405u + 2891336453u; return float(s >> 9) / 8388608.0; }

void main() { /**** RAY GENERATION SHADER ****/
  payload.rng = hash(uvec3(gl_LaunchIDEXT.xy, frameID));
  vec2 jitter = vec2(unit(payload.rng), unit(payload.rng));
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + jitter) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  vec4 before = gsnGetPreviousPixel();
  gsnSetPixel(mix(before, vec4(payload.color, 1.0), 1.0 / float(frameID + 1)));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(unit(payload.rng) < 0.5 ? 0.2 : 0.9);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.5);
}
