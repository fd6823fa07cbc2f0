#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
layout(location = 0) rayPayloadInEXT vec3 prd;
void main() {
  const GeometryData mesh = hitGeometry();
  const uint i = Uvec3Array(mesh.triangles).at[hitTriangle(mesh)].x;
  prd = Vec3Array(mesh.positions).at[i];
}
