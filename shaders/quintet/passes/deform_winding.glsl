// SPDX-License-Identifier: Apache-2.0
// Swaps two corners of the triangles that the frame mirrors and the triangles in memory do not, or the other way round
// (scene::applySkin is the same on the host). A compute shader with one invocation per triangle, for frames at which the sign of a
// determinant changes.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/passes/deform.glsl>

layout(local_size_x = kPassGroupSize) in;
layout(push_constant, scalar) uniform DeformBlock { DeformPass pass; };

// Of at least two of the three vertices.
bool isTriangleMirrored(DeformGeometry g, uvec3 triangle, uint flag) {
  uint count = 0u;
  for (int c = 0; c < 3; ++c) count += isMirrored(g, triangle[c], flag) ? 1u : 0u;
  return count >= 2u;
}

void main() {
  const uint i = passIndex();
  const DeformGeometry g = DeformGeometryArray(pass.geometry).at[0];
  if (i >= g.triangleCount) return;
  const uvec3 triangle = DeformUvec3Array(g.triangles).at[i];
  if (isTriangleMirrored(g, triangle, kDeformMirrors) != isTriangleMirrored(g, triangle, kDeformMirrored))
    DeformUvec3Array(g.triangles).at[i] = triangle.xzy;
}
