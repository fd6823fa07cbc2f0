struct RayPayloadType { vec4 rgba; };

struct RayDesc { vec3 Origin; float TMin; vec3 Direction; float TMax; };

RayDesc PrimaryRay(vec2 p) {
  RayDesc r;
  r.Origin = vec3(0.0, 0.0, 5.0);
  r.Direction = normalize(vec3(p, -2.0));
  r.TMin = 0.001;
  r.TMax = 0.001;
  return r;
}

void main() {
  /**** RAY GENERATION SHADER ****/
  const vec2 ndc = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) * 2.0 - 1.0;
  RayDesc ray = PrimaryRay(ndc);
  // EXPECT+1 Q509
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFF, 0, 0, 0, ray.Origin, ray.TMin, ray.Direction, ray.TMax, 0);
  gsnSetPixel(payload.rgba);
}

void main() {
  /**** CLOSEST-HIT SHADER ****/
  payload.rgba = vec4(baryCoord, 0.5, 1.0);
}

void main() {
  /**** MISS SHADER ****/
  payload.rgba = vec4(0.0, 0.0, 0.0, 1.0);
}
