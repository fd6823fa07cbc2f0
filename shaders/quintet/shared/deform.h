// SPDX-License-Identifier: Apache-2.0
// Data of the passes that deform vertices by morph targets and skins, and that measure the tree of a refitted BLAS (see
// src/render/scene/deformed_meshes.h).
#ifndef QUINTET_SHARED_DEFORM_H
#define QUINTET_SHARED_DEFORM_H

#include "pass.h"

QT_SHARED_BEGIN

// Displacements of a morph target. 0: no displacement of this attribute.
struct DeformTarget {
  Address positions;  // vec3[vertexCount]
  Address normals;    // vec3[vertexCount]
  Address tangents;   // vec3[vertexCount]
};
QT_SHARED_SIZE(DeformTarget, 24);

// Four joints and weights per vertex.
struct DeformSkinSet {
  Address joints;   // uvec2[vertexCount]: four indices of 16 bits, the first one in the lowest bits
  Address weights;  // vec4[vertexCount]
};
QT_SHARED_SIZE(DeformSkinSet, 16);

// DeformMatrix::flags
QT_CONSTANT kDeformMirrors = 1u;   // negative determinant: turns the outside in (scene::mirrors)
QT_CONSTANT kDeformMirrored = 2u;  // the triangles are wound for a matrix that mirrors: deform_winding.glsl compares both

// Joint transform · inverse bind matrix, or the transform of a node.
struct DeformMatrix {
  vec4 rows[3];  // of the affine matrix
  uint flags;    // kDeform…
};
QT_SHARED_SIZE(DeformMatrix, 52);

// DeformGeometry::flags
QT_CONSTANT kDeformFaceNormals = 1u;  // the normals are those of the triangles, which have vertices of their own

// A geometry that an animation deforms. Only the arrays `weights` and `matrices` change with the frame.
struct DeformGeometry {
  Address positions;          // vec3[vertexCount], undeformed
  Address normals;            // vec3[vertexCount], undeformed; 0: no normals
  Address tangents;           // vec4[vertexCount], undeformed; 0: no tangents. Requires normals
  Address deformedPositions;  // vec3[vertexCount]: written
  Address deformedNormals;    // vec3[vertexCount]: written
  Address deformedTangents;   // vec4[vertexCount]: written
  Address targets;            // DeformTarget[targetCount]
  Address skinSets;           // DeformSkinSet[skinSetCount]
  Address triangles;          // uvec3[]
  Address firstCorners;       // uint[vertexCount + 1]: first element of `corners` of each vertex
  Address corners;            // uint[]: the triangles around each vertex, ascending
  Address weights;            // float[targetCount] of the frame
  Address matrices;           // DeformMatrix[] of the frame, by joint; without skin sets, one for all vertices; 0: none
  uint vertexCount;
  uint targetCount;
  uint skinSetCount;
  uint flags;  // kDeformFaceNormals
  uint triangleCount;
  uint padding;
};
QT_SHARED_SIZE(DeformGeometry, 128);

// Push constants of the passes that deform vertices.
struct DeformPass {
  Address geometry;  // DeformGeometry
};
QT_SHARED_SIZE(DeformPass, 8);

// A node of the tree that halves a list of triangles. An empty node has low > high.
struct TreeCostNode {
  vec3 low;
  vec3 high;
  float cost;  // summed surface area of the node and all nodes below it
};
QT_SHARED_SIZE(TreeCostNode, 28);

// A geometry of the list.
struct TreeCostGeometry {
  Address positions;  // vec3[]
  Address triangles;  // uvec3[]
  uint first;         // number of triangles of the geometries before it
  uint padding;
};
QT_SHARED_SIZE(TreeCostGeometry, 24);

// An invocation reduces this many leaves, 2^kTreeCostSerialDepth, before the invocations of its workgroup combine theirs.
QT_CONSTANT kTreeCostSerialDepth = 3;
QT_CONSTANT kTreeCostLeaves = kPassGroupSize << kTreeCostSerialDepth;  // per workgroup

// The triangles of a BLAS in the order of its tree.
struct TreeCostList {
  Address order;       // uint[triangleCount]: indices of triangles; those of a geometry follow those of the one before
  Address geometries;  // TreeCostGeometry[geometryCount]
  uint triangleCount;
  uint geometryCount;
  uint depth;  // of the tree: 2^depth ≥ triangleCount
  uint padding;
};
QT_SHARED_SIZE(TreeCostList, 32);

// Push constants of the pass that computes the roots of subtrees with kTreeCostLeaves leaves.
struct TreeCostPass {
  Address leaves;  // TreeCostNode[leafCount]; 0: the triangles of the list
  Address roots;   // TreeCostNode[]: written, one per workgroup
  Address list;    // TreeCostList
  uint leafCount;  // of this level of the tree; 2^depth for triangles
  uint padding;
};
QT_SHARED_SIZE(TreeCostPass, 32);

QT_SHARED_END

#endif
