#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec3 L;

vec3 objectNormal(uint primitive) {
  const GeometryData g = hitGeometry();
  const uvec3 t = Uvec3Array(g.triangles).at[primitive];
  Vec3Array p = Vec3Array(g.positions);
  return normalize(cross(p.at[t.y] - p.at[t.x], p.at[t.z] - p.at[t.x]));
}

void main() {
  vec3 n = objectNormal(hitTriangle(hitGeometry()));
  n = normalize(vec3(n * gl_WorldToObjectEXT));
  const vec3 r = reflect(gl_WorldRayDirectionEXT, n);
  const vec3 at = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, 0xFF, kRay_mirror, kRayTypeCount, kMiss_mirror, at, 0.001, r, kInfinity, 0);
  L *= 0.9;
}
