#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 c;
struct Attr { vec3 n; uint id; };
hitAttributeEXT Attr attr;
void main() { c = 0.5 + 0.5 * normalize(attr.n); }
