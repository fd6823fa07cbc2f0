#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
layout(location = 0) rayPayloadInEXT float c;
hitAttributeEXT vec2 bary;

struct Triangle { vec3 a, b, c; };
Triangle fetch() {
  const GeometryData mesh = hitGeometry();
  const uvec3 i = Uvec3Array(mesh.triangles).at[hitTriangle(mesh)];
  Vec3Array p = Vec3Array(mesh.positions);
  return Triangle(p.at[i.x], p.at[i.y], p.at[i.z]);
}

void main() {
  const Triangle t = fetch();
  const vec3 position = gl_ObjectToWorldEXT * vec4((1.0 - bary.x - bary.y) * t.a + bary.x * t.b + bary.y * t.c, 1.0);
  const float meters = distance(position, gl_WorldRayOriginEXT);
  c = step(0.5, fract(meters));
}
