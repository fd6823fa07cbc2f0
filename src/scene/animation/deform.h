// SPDX-License-Identifier: Apache-2.0
// Deformations of vertices, computed on the host: morph targets, skins, transforms (glTF 2.0 sections 3.7.2.2 and
// 3.7.3).
#ifndef QUINTET_SCENE_ANIMATION_DEFORM_H
#define QUINTET_SCENE_ANIMATION_DEFORM_H

#include <span>

#include "scene/model/scene.h"

namespace quintet::scene {

// Whether the matrix turns the outside of a mesh in: its determinant is negative. Functions that apply such a matrix swap two
// corners of the triangles and negate the handedness of the tangents, so that the outside stays outside.
bool mirrors(const mat4& matrix);

// Adds weight · displacement to the attributes that the geometry has.
void applyMorphTarget(Geometry&, const MorphTarget&, float weight);

// Linear blend skinning. `matrices` are joint transform · inverse bind matrix; joints must be in range. Joints can mirror a part
// of the mesh: a vertex is mirrored if such joints have more than half of its weight, a triangle if two of its vertices are.
void applySkin(Geometry&, std::span<const SkinSet> sets, std::span<const mat4> matrices);

// Transforms a geometry by an affine matrix. Normals and tangents do not stay unit.
void transformVertices(Geometry&, const mat4& matrix);
// The same, but if the matrix is singular, normals and tangents are dropped.
void applyTransform(Geometry&, const mat4& matrix);

}  // namespace quintet::scene
#endif
