#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
#include "gbuffer.glsl"
layout(location = 0) rayPayloadInEXT GBuffer g;
void main() {
  const GeometryData mesh = hitGeometry();
  const uvec3 i = Uvec3Array(mesh.triangles).at[hitTriangle(mesh)];
  const vec3 a = Vec3Array(mesh.positions).at[i.x];
  const vec3 n = cross(Vec3Array(mesh.positions).at[i.y] - a, Vec3Array(mesh.positions).at[i.z] - a);
  g.position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  g.normal = normalize(vec3(n * gl_WorldToObjectEXT));
  g.valid = true;
}
