// Each pixel is a point of the unit sphere, which the light of a distant sun may reach.
struct RayPayloadType { bool lit; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 st = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy);
  vec2 angle = vec2(2.0 * PI, PI) * st;
  vec3 point = normalize(vec3(cos(angle.x) * sin(angle.y), cos(angle.y), sin(angle.x) * sin(angle.y)));
  vec3 toSun = vec3(3.0, 4.0, 12.0);
  payload.lit = false;
  traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, 0u, 0u, 0u,
              point, 0.01, toSun, 1e3, 0);
  gsnSetPixel(vec4(vec3(payload.lit ? 1.0 : 0.1), 1.0));
}

void main() { /**** MISS SHADER ****/
  payload.lit = true;
}
