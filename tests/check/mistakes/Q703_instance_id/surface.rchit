#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;

const vec3 kPalette[3] = vec3[](vec3(0.9, 0.2, 0.1), vec3(0.2, 0.8, 0.3), vec3(0.1, 0.3, 0.9));

void main() {
  payload.color = kPalette[gl_InstanceID % 3];  // EXPECT Q703
  payload.t = gl_HitTEXT;
}
