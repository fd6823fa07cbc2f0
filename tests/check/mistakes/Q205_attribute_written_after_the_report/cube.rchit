#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 farbe;
hitAttributeEXT vec3 faceNormal;
// EXPECT+1 Q205
void main() { farbe = 0.5 + 0.5 * faceNormal; }
