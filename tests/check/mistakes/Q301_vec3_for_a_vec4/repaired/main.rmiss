#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
layout(location = 0) rayPayloadInEXT vec3 color;
layout(location = 0) callableDataEXT vec4 args;
void main() {
  args = vec4(gl_WorldRayDirectionEXT, 0.0);
  executeCallableEXT(kCallable_sky, 0);
  color = args.rgb;
}
