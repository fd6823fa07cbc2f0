#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_nonuniform_qualifier : require
#include "payload.glsl"

layout(set = 0, binding = 1) uniform samplerCube skies[];  // EXPECT Q651
layout(location = 0) rayPayloadInEXT Payload payload;

void main() {
  payload.color = textureLod(skies[0], gl_WorldRayDirectionEXT, 0.0).rgb;
  payload.t = -1.0;
}
