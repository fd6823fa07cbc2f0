#version 460
#extension GL_EXT_ray_tracing : require
#include "path.glsl"
layout(location = 0) rayPayloadInEXT Path path;
void main() {
  path.origin = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  const float z = 2.0 * random(path.seed) - 1.0;
  const float phi = 6.2831853 * random(path.seed);
  path.direction = vec3(sqrt(max(1.0 - z * z, 0.0)) * vec2(cos(phi), sin(phi)), z);
  path.throughput *= 0.6;
}
