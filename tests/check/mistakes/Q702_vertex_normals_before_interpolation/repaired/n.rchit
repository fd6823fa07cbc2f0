#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
layout(location = 0) rayPayloadInEXT vec3 value;
hitAttributeEXT vec2 uv;

vec3 fetch(Vec3Array data, uint i) {
  return vec3(data.at[i] * gl_WorldToObjectEXT);
}

void main() {
  GeometryData mesh = hitGeometry();
  value = vec3(0.5);
  if (mesh.normals == 0ul) return;
  Vec3Array n = Vec3Array(mesh.normals);
  uvec3 tri = Uvec3Array(mesh.triangles).at[hitTriangle(mesh)];
  vec3 sum = (1.0 - uv.x - uv.y) * fetch(n, tri.x) + uv.x * fetch(n, tri.y) + uv.y * fetch(n, tri.z);
  value = 0.5 + 0.5 * normalize(sum);
}
