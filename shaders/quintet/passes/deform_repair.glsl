// SPDX-License-Identifier: Apache-2.0
// Replaces the normals and tangents that deform_vertices.glsl could not compute: a normal becomes the mean of the face
// normals around the vertex, weighted by the area, and a tangent some vector perpendicular to the normal. A compute
// shader with one invocation per vertex, for geometries with normals.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/bsdf/local_frame.glsl>
#include <quintet/passes/deform.glsl>

layout(local_size_x = kPassGroupSize) in;
layout(push_constant, scalar) uniform DeformBlock { DeformPass pass; };

vec3 meanFaceNormal(DeformGeometry g, uint vertex) {
  vec3 sum = vec3(0.0);
  const uint end = DeformUintArray(g.firstCorners).at[vertex + 1u];
  for (uint k = DeformUintArray(g.firstCorners).at[vertex]; k < end; ++k) {
    const uvec3 triangle = DeformUvec3Array(g.triangles).at[DeformUintArray(g.corners).at[k]];
    const vec3 p = DeformVec3Array(g.deformedPositions).at[triangle.x];
    const vec3 normal = cross(DeformVec3Array(g.deformedPositions).at[triangle.y] - p,
                              DeformVec3Array(g.deformedPositions).at[triangle.z] - p);
    if (!isNotFinite(normal)) sum += normal;
  }
  return normalizeDirection(sum) ? sum : vec3(0.0, 1.0, 0.0);
}

void main() {
  const uint i = passIndex();
  const DeformGeometry g = DeformGeometryArray(pass.geometry).at[0];
  if (i >= g.vertexCount) return;
  vec3 normal = DeformVec3Array(g.deformedNormals).at[i];
  if (normal == vec3(0.0)) {
    normal = meanFaceNormal(g, i);
    DeformVec3Array(g.deformedNormals).at[i] = normal;
  }
  if (g.tangents == 0ul) return;
  const vec4 tangent = DeformVec4Array(g.deformedTangents).at[i];
  if (tangent.xyz == vec3(0.0))
    DeformVec4Array(g.deformedTangents).at[i] = vec4(localFrame(normal)[0], tangent.w);
}
