// SPDX-License-Identifier: Apache-2.0
// Deformations into the rest pose of a file, computed on the host: morph targets with their default weights, skins with
// the rest transforms of the joints (glTF 2.0 sections 3.7.2.2 and 3.7.3).
#ifndef QUINTET_SCENE_ANIMATION_DEFORM_H
#define QUINTET_SCENE_ANIMATION_DEFORM_H

#include <span>

#include "scene/model/scene.h"

namespace quintet::scene {

// Displacements of one target. Each vector is empty or has one element per position.
struct MorphTarget {
  std::vector<vec3> positions;
  std::vector<vec3> normals;
  std::vector<vec3> tangents;
};

// Adds weight · displacement to the attributes that the geometry has.
void applyMorphTarget(Geometry&, const MorphTarget&, float weight);

// Four joints and weights per vertex. A mesh can have two sets.
struct SkinSet {
  std::vector<glm::u16vec4> joints;  // indices into `matrices`
  std::vector<vec4> weights;         // applySkin normalizes their sum over all sets
};

// Linear blend skinning. `matrices` are joint transform · inverse bind matrix; joints must be in range.
void applySkin(Geometry&, std::span<const SkinSet> sets, std::span<const mat4> matrices);

// Transforms positions, normals and tangents by an affine matrix. If it is singular, normals and tangents are dropped.
void applyTransform(Geometry&, const mat4& matrix);

}  // namespace quintet::scene
#endif
