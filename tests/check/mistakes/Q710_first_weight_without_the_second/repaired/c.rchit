#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
layout(location = 0) rayPayloadInEXT vec3 value;
hitAttributeEXT vec2 attribs;

void main() {
  const vec3 barycentrics = vec3(1.0 - attribs.x - attribs.y, attribs.x, attribs.y);
  const GeometryData mesh = hitGeometry();
  const uvec3 ind = Uvec3Array(mesh.triangles).at[hitTriangle(mesh)];
  Vec3Array vertices = Vec3Array(mesh.positions);
  const vec3 v0 = vertices.at[ind.x];
  const vec3 v1 = vertices.at[ind.y];
  const vec3 v2 = vertices.at[ind.z];
  const vec3 pos = v0 * barycentrics.x + v1 * barycentrics.y + v2 * barycentrics.z;
  value = fract(pos);
}
