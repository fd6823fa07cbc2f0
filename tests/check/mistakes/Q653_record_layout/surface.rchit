#version 460
#extension GL_EXT_ray_tracing : require
#include "payload.glsl"

layout(shaderRecordEXT, std430) buffer SurfaceRecord {  // EXPECT Q653
  float roughness;
  vec3 tint;
} record;
layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 baryCoord;

void main() {
  payload.color = record.tint * record.roughness;
  payload.t = gl_HitTEXT;
}
