#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
layout(location = 0) rayPayloadInEXT vec3 cor;

void main() {
  const GeometryData malha = hitGeometry();
  const uvec3 i = Uvec3Array(malha.triangles).at[hitTriangle(malha)];
  const vec3 a = Vec3Array(malha.positions).at[i.x];
  const vec3 b = Vec3Array(malha.positions).at[i.y];
  const vec3 c = Vec3Array(malha.positions).at[i.z];
  const vec3 face = cross(b - a, c - a);
  const vec3 mundo = normalize(mat3(gl_ObjectToWorldEXT) * face);  // EXPECT Q702
  cor = vec3(abs(dot(mundo, gl_WorldRayDirectionEXT)));
}
