// Every intersection is ignored on purpose: the shader counts the layers along the ray.
struct RayPayloadType { float layers; };

void main() { /**** RAY GENERATION SHADER ****/
  vec2 ndc = 2.0 * (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 1.0;
  payload.layers = 0.0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 6), 0.001, normalize(vec3(ndc, -2)), 1e3, 0);
  gsnSetPixel(vec4(vec3(0.1 * payload.layers), 1.0));
}

void main() { /**** ANY-HIT SHADER ****/
  payload.layers += 1.0;
  ignoreIntersectionEXT;
}
