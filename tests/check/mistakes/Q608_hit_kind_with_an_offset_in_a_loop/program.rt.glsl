/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
const uint kFirstKind = 124u;
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 p = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 5), 0.001, normalize(vec3(p, -2.0)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  // Two planes; the kind is the index of the plane.
  for (uint i = 4u; i < 6u; ++i) {
    float z = i % 2u == 0u ? -0.5 : 0.5;
    float t = (z - gl_ObjectRayOriginEXT.z) / gl_ObjectRayDirectionEXT.z;
    vec2 q = abs(gl_ObjectRayOriginEXT.xy + t * gl_ObjectRayDirectionEXT.xy);
    // EXPECT+1 Q608
    if (max(q.x, q.y) < 0.5) reportIntersectionEXT(t, kFirstKind + i);
  }
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(float(gl_HitKindEXT - kFirstKind) / 6.0);
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
