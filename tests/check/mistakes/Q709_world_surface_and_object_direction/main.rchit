#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit.glsl>
#include <quintet/surface.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
void main() {
  const Surface s = fetchSurface(triangleHit(b, 0u), -gl_WorldRayDirectionEXT);
  const vec3 view = -normalize(gl_ObjectRayDirectionEXT);
  c = vec3(pow(1.0 - max(dot(s.shadingNormal, view), 0.0), 3.0));  // EXPECT Q709
}
