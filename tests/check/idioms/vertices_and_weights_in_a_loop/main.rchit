#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/hit_geometry.glsl>
layout(location = 0) rayPayloadInEXT vec3 c;
hitAttributeEXT vec2 st;
void main() {
  const GeometryData g = hitGeometry();
  const uvec3 corner = Uvec3Array(g.triangles).at[hitTriangle(g)];
  const float weight[3] = float[](1.0 - st.s - st.t, st.s, st.t);
  vec3 object = vec3(0.0);
  for (int k = 0; k < 3; ++k) object += weight[k] * Vec3Array(g.positions).at[corner[k]];
  c = fract(gl_ObjectToWorldEXT * vec4(object, 1.0));
}
