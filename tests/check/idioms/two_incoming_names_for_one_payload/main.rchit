#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 5) rayPayloadInEXT vec4 ergebnis;
void main() { ergebnis = vec4(vec3(0.6), ergebnis.a * 0.5); }
