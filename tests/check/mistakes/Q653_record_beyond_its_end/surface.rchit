#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_scalar_block_layout : require
#include "payload.glsl"

layout(shaderRecordEXT, scalar) buffer SurfaceRecord {  // EXPECT Q653
  float roughness;
  vec3 tint;
  vec3 glow;
} record;
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

void main() {
  payload.color = record.tint * record.roughness + record.glow;
  payload.t = gl_HitTEXT;
}
