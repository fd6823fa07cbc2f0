// SPDX-License-Identifier: Apache-2.0
// Deformations of vertices, computed on the host: morph targets, skins, transforms (glTF 2.0 sections 3.7.2.2 and
// 3.7.3).
#ifndef QUINTET_SCENE_ANIMATION_DEFORM_H
#define QUINTET_SCENE_ANIMATION_DEFORM_H

#include <span>

#include "scene/model/scene.h"

namespace quintet::scene {

// Adds weight · displacement to the attributes that the geometry has.
void applyMorphTarget(Geometry&, const MorphTarget&, float weight);

// Linear blend skinning. `matrices` are joint transform · inverse bind matrix; joints must be in range.
void applySkin(Geometry&, std::span<const SkinSet> sets, std::span<const mat4> matrices);

// Transforms positions, normals and tangents by an affine matrix. Normals and tangents do not stay unit.
void transformVertices(Geometry&, const mat4& matrix);
// The same, but if the matrix is singular, normals and tangents are dropped.
void applyTransform(Geometry&, const mat4& matrix);

}  // namespace quintet::scene
#endif
