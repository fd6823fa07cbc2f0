// A ray without a hit is as long as its tmax: fog hides everything farther than that.
struct RayPayloadType { vec3 color; float t; };

const float far = 60.0;

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), far, 0);
  gsnSetPixel(vec4(mix(vec3(0.6), payload.color, exp(-0.08 * payload.t)), 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = vec3(baryCoord, 0.5); payload.t = gl_HitTEXT; }
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.2); payload.t = gl_RayTmaxEXT; }
