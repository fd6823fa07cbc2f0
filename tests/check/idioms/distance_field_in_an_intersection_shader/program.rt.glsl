/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct HitAttributeType { vec3 normal; int steps; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 q = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0, 0xFF, 0, 0, 0, vec3(0, 0, 4), 0.01, normalize(vec3(q, -1.5)), 100.0, 0);
  gsnSetPixel(vec4(payload.color, 1));
}

float torus(vec3 p) { return length(vec2(length(p.xz) - 0.35, p.y)) - 0.12; }
vec3 gradient(vec3 p) {
  const vec2 e = vec2(1e-3, 0.0);
  return vec3(torus(p + e.xyy) - torus(p - e.xyy), torus(p + e.yxy) - torus(p - e.yxy), torus(p + e.yyx) - torus(p - e.yyx));
}

void main() { /**** INTERSECTION SHADER ****/
  // The distance field has lengths of object space; t has units of the direction.
  float inverse = 1.0 / length(gl_ObjectRayDirectionEXT);
  float t = gl_RayTminEXT;
  int i = 0;
  while (i < 96 && t < gl_RayTmaxEXT) {
    vec3 p = gl_ObjectRayOriginEXT + t * gl_ObjectRayDirectionEXT;
    float d = torus(p);
    if (d < 5e-4) {
      hit.normal = normalize(gradient(p));
      hit.steps = i;
      reportIntersectionEXT(t, 0u);
      return;
    }
    t += d * inverse;
    ++i;
  }
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 n = normalize(vec3(hit.normal * gl_WorldToObjectEXT));
  payload.color = (0.5 + 0.5 * n) * (1.0 - float(hit.steps) / 96.0);
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.02); }
