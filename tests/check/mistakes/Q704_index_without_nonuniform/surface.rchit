#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/texture.glsl>
#include <quintet/generated/program.glsl>
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

uint mapOf(int instance) { return parameters.firstMap + uint(instance) * parameters.mapsPerInstance; }

void main() {
  payload.color = textureLod(textures[mapOf(gl_InstanceCustomIndexEXT)], baryCoord, 0.0).rgb;  // EXPECT Q704
  payload.t = gl_HitTEXT;
}
