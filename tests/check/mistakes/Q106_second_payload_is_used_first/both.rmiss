#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 radiance;
layout(location = 1) rayPayloadInEXT float visible;  // EXPECT Q106
void main() {
  visible = 1.0;
  radiance = vec3(0.3, 0.5, 0.9);
}
