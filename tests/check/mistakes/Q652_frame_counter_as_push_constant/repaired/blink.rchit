#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/frame.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
void main() {
  c = vec3(0.5 + 0.5 * sin(0.1 * float(launch.firstSample)), float(launch.firstSample & 1u), 0.0);
}
