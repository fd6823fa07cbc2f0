#version 460
#extension GL_EXT_ray_tracing : require
#include "path.glsl"
layout(location = 0) rayPayloadInEXT Path path;
void main() {
  path.radiance += path.throughput * vec3(0.8, 0.9, 1.0);
  path.ended = true;
}
