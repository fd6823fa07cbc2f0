// Spheres by an intersection shader; the flags come from a program for meshes.
/**** COMMON START ****/
struct RayPayloadType {
  vec3 shade;
};
struct HitAttributeType {
  vec3 n;
};
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 v = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  // EXPECT+1 Q513
  traceRayEXT(topLevelAS, gl_RayFlagsSkipAABBEXT, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 5), 1e-3, normalize(vec3(v, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.shade, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 lower, upper;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, lower, upper);
  vec3 oc = gl_ObjectRayOriginEXT - 0.5 * (lower + upper);
  vec3 d = gl_ObjectRayDirectionEXT;
  float r = 0.5 * (upper.x - lower.x);
  float qa = dot(d, d), qb = dot(oc, d), qc = dot(oc, oc) - r * r;
  float disc = qb * qb - qa * qc;
  if (disc < 0.0) return;
  float t = (-qb - sqrt(disc)) / qa;
  hit.n = oc + t * d;
  reportIntersectionEXT(t, 0u);
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.shade = 0.5 + 0.5 * normalize(hit.n);
}

void main() { /**** MISS SHADER ****/
  payload.shade = vec3(0.0);
}
