// The flag and the member are set under equal conditions, far from each other.
struct RayPayloadType { bool hasLight; float t; vec3 light; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  vec3 c = vec3(payload.t < 0.0 ? 0.0 : 0.1);
  if (payload.hasLight) c += payload.light;
  if (payload.t > 0.0 && payload.t < 5.0) c *= payload.light.b;
  gsnSetPixel(vec4(c, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  payload.t = gl_HitTEXT;
  payload.hasLight = false;
  if (gl_HitTEXT < 5.0) payload.hasLight = true;
  float weight = 1.0 - baryCoord.x;
  if (gl_HitTEXT < 5.0) payload.light = vec3(weight);
}

void main() { /**** MISS SHADER ****/
  payload.t = -1.0;
  payload.hasLight = false;
}
