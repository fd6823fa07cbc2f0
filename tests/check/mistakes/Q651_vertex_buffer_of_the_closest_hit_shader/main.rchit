#version 460
#extension GL_EXT_ray_tracing : require
layout(location = 0) rayPayloadInEXT vec3 prd;
layout(set = 0, binding = 3, std430) readonly buffer Vertices { float v[]; } vertices;  // EXPECT Q651
layout(set = 0, binding = 4, std430) readonly buffer Indices { uint i[]; } indices;  // EXPECT Q651
void main() {
  const uint i = indices.i[3 * gl_PrimitiveID];
  prd = vec3(vertices.v[3 * i], vertices.v[3 * i + 1], vertices.v[3 * i + 2]);
}
