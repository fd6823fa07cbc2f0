// The distance of a miss is tmax, and the receiver compares with it.
struct RayPayloadType { vec3 normal; float t; };

const float far = 1000.0;

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  vec3 eye = vec3(0, 0, 6), dir = normalize(vec3(ndc, -2));
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, eye, 0.001, dir, far, 0);
  vec3 color = vec3(0.1, 0.2, 0.4);
  if (payload.t > 0.0 && payload.t < far) {
    vec3 position = eye + payload.t * dir + 0.001 * payload.normal;
    traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, position, 0.0, reflect(dir, payload.normal), far, 0);
    color = payload.t < far ? vec3(0.4) : vec3(0.9);
  }
  gsnSetPixel(vec4(color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/ payload.normal = -gl_WorldRayDirectionEXT; payload.t = gl_HitTEXT; }
void main() { /**** MISS SHADER ****/ payload.normal = vec3(0.0); payload.t = gl_RayTmaxEXT; }
