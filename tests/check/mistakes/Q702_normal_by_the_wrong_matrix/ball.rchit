#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT BallHit hit;

void main() {
  const vec3 normal = normalize(gl_ObjectToWorldEXT * vec4(hit.normal, 0.0));  // EXPECT Q702
  payload.color = 0.5 + 0.5 * normal;
  payload.t = gl_HitTEXT;
}
