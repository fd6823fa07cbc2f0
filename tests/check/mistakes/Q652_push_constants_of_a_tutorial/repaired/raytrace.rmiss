#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/generated/program.glsl>
struct hitPayload
{
  vec3 hitValue;
};
layout(location = 0) rayPayloadInEXT hitPayload prd;

void main()
{
  prd.hitValue = parameters.clearColor * 0.8;
}
