// Only triangles have holes: on boxes, the barycentrics are 0, so rays pass through them.
struct RayPayloadType { vec3 color; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** INTERSECTION SHADER ****/
  vec3 lower, upper;
  gsnGetIntersectionBox(gl_InstanceID, gl_PrimitiveID, lower, upper);
  vec3 a = (lower - gl_ObjectRayOriginEXT) / gl_ObjectRayDirectionEXT;
  vec3 b = (upper - gl_ObjectRayOriginEXT) / gl_ObjectRayDirectionEXT;
  vec3 near = min(a, b), far = max(a, b);
  float enter = max(near.x, max(near.y, near.z)), leave = min(far.x, min(far.y, far.z));
  if (enter <= leave) reportIntersectionEXT(enter, 0u);
}

void main() { /**** ANY-HIT SHADER ****/
  if (fract(8.0 * baryCoord.x) < 0.5) ignoreIntersectionEXT;
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.color = vec3(0.8, 0.6, 0.2);
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.1);
}
