#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT float radius2;
const vec3 colors[3] = vec3[](vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1));
void main() { c = colors[gl_HitKindEXT] * (1.0 - radius2); }
