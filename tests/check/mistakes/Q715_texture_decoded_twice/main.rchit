#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/texture.glsl>
#include <quintet/generated/program.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
vec3 toLinear(vec3 srgb) { return pow(srgb, vec3(2.2)); }  // EXPECT Q715
void main() {
  c = toLinear(sampleParameter(parameters.albedoMap, b).rgb);
}
