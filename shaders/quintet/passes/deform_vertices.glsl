// SPDX-License-Identifier: Apache-2.0
// Applies morph targets and linear blend skinning to each vertex (scene::deformGeometry is the same on the host). Writes
// unit normals and tangents; (0,0,0) for those without a direction, which deform_repair.glsl replaces. A compute shader
// with one invocation per vertex.
#extension GL_EXT_scalar_block_layout : require
#include <quintet/passes/deform.glsl>

layout(local_size_x = kPassGroupSize) in;
layout(push_constant, scalar) uniform DeformBlock { DeformPass pass; };

// Adds weight · displacement.
void morph(DeformGeometry g, uint i, inout vec3 position, inout vec3 normal, inout vec3 tangent) {
  for (uint k = 0u; k < g.targetCount; ++k) {
    const float weight = DeformFloatArray(g.weights).at[k];
    if (weight == 0.0) continue;
    const DeformTarget target = DeformTargetArray(g.targets).at[k];
    if (target.positions != 0ul) position += weight * DeformVec3Array(target.positions).at[i];
    if (target.normals != 0ul) normal += weight * DeformVec3Array(target.normals).at[i];
    if (target.tangents != 0ul) tangent += weight * DeformVec3Array(target.tangents).at[i];
  }
}

void addMatrix(inout DeformMatrix sum, Address matrices, uint joint, float weight) {
  if (weight == 0.0) return;
  const DeformMatrix matrix = DeformMatrixArray(matrices).at[joint];
  for (int row = 0; row < 3; ++row) sum.rows[row] += weight * matrix.rows[row];
}

// The mean of the joint matrices of a vertex, with the normalized weights of all sets.
DeformMatrix blendedMatrix(DeformGeometry g, uint i) {
  if (g.skinSetCount == 0u) return DeformMatrixArray(g.matrices).at[0];
  float sum = 0.0;
  for (uint s = 0u; s < g.skinSetCount; ++s) {
    const vec4 weights = DeformVec4Array(DeformSkinSetArray(g.skinSets).at[s].weights).at[i];
    sum += weights.x + weights.y + weights.z + weights.w;
  }
  if (isNotFinite(vec3(sum)) || !(sum > 0.0)) {  // without a weight, the first joint applies
    const uvec2 joints = DeformUvec2Array(DeformSkinSetArray(g.skinSets).at[0].joints).at[i];
    return DeformMatrixArray(g.matrices).at[joints.x & 0xFFFFu];
  }
  DeformMatrix blended = DeformMatrix(vec4[3](vec4(0.0), vec4(0.0), vec4(0.0)), 0u);
  for (uint s = 0u; s < g.skinSetCount; ++s) {
    const DeformSkinSet set = DeformSkinSetArray(g.skinSets).at[s];
    const uvec2 joints = DeformUvec2Array(set.joints).at[i];
    const vec4 weights = DeformVec4Array(set.weights).at[i] / sum;
    addMatrix(blended, g.matrices, joints.x & 0xFFFFu, weights.x);
    addMatrix(blended, g.matrices, joints.x >> 16u, weights.y);
    addMatrix(blended, g.matrices, joints.y & 0xFFFFu, weights.z);
    addMatrix(blended, g.matrices, joints.y >> 16u, weights.w);
  }
  return blended;
}

// The inverse transpose up to a positive factor: the signed cofactors, without a division.
vec3 transformNormal(DeformMatrix matrix, vec3 normal) {
  const mat3 m = transpose(mat3(matrix.rows[0].xyz, matrix.rows[1].xyz, matrix.rows[2].xyz));
  const mat3 cofactors = mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
  const vec3 transformed = cofactors * normal;
  return dot(m[0], cofactors[0]) < 0.0 ? -transformed : transformed;
}

vec3 transformDirection(DeformMatrix matrix, vec3 v) {
  return vec3(dot(matrix.rows[0].xyz, v), dot(matrix.rows[1].xyz, v), dot(matrix.rows[2].xyz, v));
}

vec3 unitOrZero(vec3 v) { return normalizeDirection(v) ? v : vec3(0.0); }

void main() {
  const uint i = passIndex();
  const DeformGeometry g = DeformGeometryArray(pass.geometry).at[0];
  if (i >= g.vertexCount) return;
  const vec3 undeformed = DeformVec3Array(g.positions).at[i];
  vec3 position = undeformed, normal = vec3(0.0);
  vec4 tangent = vec4(0.0);
  if (g.normals != 0ul) normal = DeformVec3Array(g.normals).at[i];
  if (g.tangents != 0ul) tangent = DeformVec4Array(g.tangents).at[i];
  morph(g, i, position, normal, tangent.xyz);
  if (g.matrices != 0ul) {
    const DeformMatrix matrix = blendedMatrix(g, i);
    position = vec3(dot(matrix.rows[0], vec4(position, 1.0)), dot(matrix.rows[1], vec4(position, 1.0)),
                    dot(matrix.rows[2], vec4(position, 1.0)));
    normal = transformNormal(matrix, normal);
    tangent.xyz = transformDirection(matrix, tangent.xyz);
    if (g.tangents != 0ul && isMirrored(g, i, kDeformMirrors)) tangent.w = -tangent.w;
  }
  DeformVec3Array(g.deformedPositions).at[i] = isNotFinite(position) ? undeformed : position;
  if ((g.flags & kDeformFaceNormals) != 0u) normal = vec3(0.0);
  if (g.normals != 0ul) DeformVec3Array(g.deformedNormals).at[i] = unitOrZero(normal);
  if (g.tangents != 0ul)
    DeformVec4Array(g.deformedTangents).at[i] = vec4(unitOrZero(tangent.xyz), tangent.w < 0.0 ? -1.0 : 1.0);
}
