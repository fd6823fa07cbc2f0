#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 5) rayPayloadInEXT vec4 fromCamera;
void main() { fromCamera.rgb += fromCamera.a * vec3(0.1, 0.2, 0.3); }
