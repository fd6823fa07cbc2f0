#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit.glsl>
#include <quintet/surface.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
void main() {
  const InstanceData instance = InstanceArray(frame.instances).at[gl_InstanceCustomIndexEXT];
  const GeometryData g = hitGeometry();
  c = vec3(0.2);
  if (g.normals == 0ul) return;
  const uvec3 v = Uvec3Array(g.triangles).at[hitTriangle(g)];
  Vec3Array n = Vec3Array(g.normals);
  const vec3 local = n.at[v.x] + b.x * (n.at[v.y] - n.at[v.x]) + b.y * (n.at[v.z] - n.at[v.x]);
  const vec3 world = normalize(rowsTimesVector(instance.worldFromObject, local));  // EXPECT Q702
  c = 0.5 + 0.5 * world;
}
