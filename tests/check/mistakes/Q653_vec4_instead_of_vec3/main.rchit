#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_scalar_block_layout : require
layout(location = 0) rayPayloadInEXT vec3 c;
struct MyRecord { vec4 diffuse; vec4 gloss; };
layout(shaderRecordEXT, scalar) buffer R { MyRecord record; };  // EXPECT Q653
void main() { c = record.diffuse.rgb * (1.0 - record.gloss.x); }
