/**** COMMON START ****/
struct Material { vec3 albedo; float metal; };
struct RayPayloadType { Material m; float t; };
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  vec3 c = vec3(0.0);
  if (payload.t > 0.0) c = payload.m.albedo * (1.0 - payload.m.metal);
  gsnSetPixel(vec4(c, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.t = gl_HitTEXT;
  payload.m.albedo = vec3(0.9, 0.7, 0.3);
  payload.m.metal = gl_PrimitiveID % 2 == 0 ? 1.0 : 0.0;
}

void main() { /**** MISS SHADER ****/
  payload.t = -1.0;
  payload.m = Material(vec3(0.0), 0.0);
}
