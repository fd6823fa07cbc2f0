#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  payload.color = vec3(0.3, 0.5, 0.9);
  payload.t = -1.0;
}
