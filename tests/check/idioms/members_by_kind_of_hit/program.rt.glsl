// The kind says which members the hit has set.
struct RayPayloadType { int kind; float t; vec3 albedo; float ior; bool twoSided; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  vec3 c = vec3(0.2);
  if (payload.t > 0.0) {
    if (payload.kind == 1) c = payload.albedo;
    if (payload.kind == 2) c = vec3(payload.ior - 1.0);
    if (payload.twoSided) c *= payload.albedo.r;
  }
  gsnSetPixel(vec4(c, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.t = gl_HitTEXT;
  payload.twoSided = gl_InstanceCustomIndexEXT == 3;
  payload.kind = gl_InstanceCustomIndexEXT < 2 ? 2 : 1;
  if (gl_InstanceCustomIndexEXT < 2)
    payload.ior = 1.5;
  else
    payload.albedo = vec3(baryCoord, 1.0);
}

void main() { /**** MISS SHADER ****/
  payload.t = -1.0;
}
