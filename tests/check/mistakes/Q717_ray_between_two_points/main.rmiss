#version 460
#extension GL_EXT_ray_tracing : require
struct Hit { vec3 albedo; float t; };
layout(location = 0) rayPayloadInEXT Hit hit;
void main() {
  hit = Hit(vec3(0.1, 0.2, 0.3), -1.0);
}
