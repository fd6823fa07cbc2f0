#version 460
#extension GL_EXT_ray_tracing : require
struct Hit { vec3 normal; float distance; };
layout(location = 0) rayPayloadInEXT Hit hit;
void main() {
  hit.normal = vec3(0.0, 1.0, 0.0);
  hit.distance = gl_RayTmaxEXT;  // EXPECT Q719
}
