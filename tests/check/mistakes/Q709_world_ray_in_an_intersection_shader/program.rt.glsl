/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct HitAttributeType { vec3 local; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 mn, mx;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, mn, mx);
  vec3 ro = gl_WorldRayOriginEXT;
  vec3 rd = gl_WorldRayDirectionEXT;
  vec3 t0 = (mn - ro) / rd;  // EXPECT Q709
  vec3 t1 = (mx - ro) / rd;  // EXPECT Q709
  vec3 lo = min(t0, t1), hi = max(t0, t1);
  float enter = max(lo.x, max(lo.y, lo.z)), leave = min(hi.x, min(hi.y, hi.z));
  if (enter > leave) return;
  hit.local = ro + enter * rd;
  reportIntersectionEXT(enter, 0u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = fract(4.0 * hit.local);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.02);
}
