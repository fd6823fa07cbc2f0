#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT Ball ball;

void main() {
  payload.color = ball.normal * ball.height;
}
