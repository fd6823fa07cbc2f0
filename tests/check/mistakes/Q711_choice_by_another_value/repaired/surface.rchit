#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

const vec3 kColors[4] = vec3[](vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0), vec3(1.0));

void main() {
  const vec3 color = kColors[gl_PrimitiveID % 4];
  payload.color = baryCoord.x > 0.5 ? color : vec3(0.0);
  payload.t = gl_HitTEXT;
}
