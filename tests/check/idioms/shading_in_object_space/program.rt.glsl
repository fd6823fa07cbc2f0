// The lamp is transformed to object space, and everything is computed there.
struct RayPayloadType { vec3 color; };
const vec3 lampWorld = vec3(3.0, 4.0, 5.0);

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  vec3 lamp = gl_WorldToObjectEXT * vec4(lampWorld, 1.0);
  vec3 p = gl_ObjectRayOriginEXT + gl_HitTEXT * gl_ObjectRayDirectionEXT;
  vec3 a, b, c;
  gsnGetPositions(gl_InstanceID, gl_PrimitiveID, a, b, c);
  vec3 n = normalize(cross(b - a, c - a));
  payload.color = vec3(abs(dot(n, normalize(lamp - p))));
}

void main() { /**** MISS SHADER ****/
  payload.color = vec3(0.0);
}
