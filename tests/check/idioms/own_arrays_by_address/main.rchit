#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Corners { vec3 p[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Faces { uint v[]; };
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 b;
void main() {
  const GeometryData g = hitGeometry();
  Corners corners = Corners(g.positions);
  Faces faces = Faces(g.triangles);
  const uint first = 3u * hitTriangle(g);
  const vec3 p = corners.p[faces.v[first + 1u]] * b.x + corners.p[faces.v[first + 2u]] * b.y +
                 corners.p[faces.v[first]] * (1.0 - b.x - b.y);
  c = 0.5 + 0.5 * sin(10.0 * p);
}
