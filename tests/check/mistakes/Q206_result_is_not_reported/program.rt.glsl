/**** COMMON START ****/
struct RayPayloadType { float v; };
struct HitAttributeType { float t; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 q = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0, 0xFF, 0, 0, 0, vec3(0, 0, 4), 0.01, normalize(vec3(q, -1.5)), 100.0, 0);
  gsnSetPixel(vec4(vec3(payload.v), 1));
}

bool hitSphere(vec3 center, float radius, out float t) {
  vec3 oc = gl_ObjectRayOriginEXT - center;
  float a = dot(gl_ObjectRayDirectionEXT, gl_ObjectRayDirectionEXT);
  float hb = dot(oc, gl_ObjectRayDirectionEXT);
  float disc = hb * hb - a * (dot(oc, oc) - radius * radius);
  t = disc > 0.0 ? (-hb - sqrt(disc)) / a : -1.0;
  return disc > 0.0;
}

void main() { /**** INTERSECTION SHADER ****/  // EXPECT Q206
  float t;
  if (hitSphere(vec3(0.0), 0.5, t)) {
    hit.t = t;  // as in a compute shader: the caller reads the result
  }
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.v = 1.0 / hit.t;
}

void main() { /**** MISS SHADER ****/
  payload.v = 0.0;
}
