/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
struct Paint { vec3 base; float shine; };
const Paint paints[3] = Paint[](Paint(vec3(0.8, 0.1, 0.1), 0.5), Paint(vec3(0.1, 0.6, 0.1), 0.2), Paint(vec3(0.1, 0.1, 0.7), 0.0));
/**** COMMON END ****/

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}

void main() { /**** CLOSEST-HIT SHADER ****/
  // The scene counts the paints from 1.
  Paint paint = paints[gl_InstanceCustomIndexEXT - 1];
  payload.color = paint.base + paint.shine * baryCoord.x;
}

void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
