#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit.glsl>
#include "payload.glsl"

layout(location = 0) rayPayloadInEXT Payload payload;
hitAttributeEXT vec2 attributes;

void main() {
  const GeometryData geometry = hitGeometry();
  const uvec3 v = Uvec3Array(geometry.triangles).at[hitTriangle(geometry)];
  Vec3Array data = Vec3Array(geometry.normals);
  const vec3 b = vec3(1.0 - attributes.x - attributes.y, attributes);
  const vec3 a = b.x * data.at[v.x] + b.y * data.at[v.y] + b.z * data.at[v.z];
  payload.color = vec3(0.8);
  payload.normal = normalize(vec3(a * gl_WorldToObjectEXT));
  payload.t = gl_HitTEXT;
}
