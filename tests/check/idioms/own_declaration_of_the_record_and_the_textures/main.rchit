#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_scalar_block_layout : require
struct Surface { vec3 tint; float repeat; };
layout(shaderRecordEXT, scalar) buffer Block { Surface data; };
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
void main() { c = data.tint * fract(data.repeat * b.x); }
