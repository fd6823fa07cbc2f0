#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(location = 1) rayPayloadInEXT Shadow shadow;

void main() {
  shadow.visible = 1.0;
}
