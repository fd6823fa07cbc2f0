#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 c;
layout(push_constant) uniform Push { layout(offset = 64) float time; uint frameIndex; } push;  // EXPECT Q652
void main() {
  c = vec3(0.5 + 0.5 * sin(push.time), float(push.frameIndex & 1u), 0.0);
}
