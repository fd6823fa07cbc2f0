// The file's rest pose, computed on the host: morph targets with their default weights, skins with the
// joints' rest transforms (glTF 2.0 sections 3.7.2.2 and 3.7.3).
#ifndef QUINTET_SCENE_DEFORM_H
#define QUINTET_SCENE_DEFORM_H

#include <span>

#include "scene/scene.h"

namespace quintet::scene {

// Displacements of one target; each empty or as long as the positions.
struct MorphTarget {
  std::vector<vec3> positions;
  std::vector<vec3> normals;
  std::vector<vec3> tangents;
};

// Adds weight · displacement. Attributes that the geometry lacks are left out.
void applyMorphTarget(Geometry&, const MorphTarget&, float weight);

// One set of four joints and weights per vertex; a mesh may have two.
struct SkinSet {
  std::vector<glm::u16vec4> joints;  // into `matrices`
  std::vector<vec4> weights;         // normalised over all sets here
};

// Linear blend skinning; `matrices` are joint transform · inverse bind matrix. Joints must be in range.
void applySkin(Geometry&, std::span<const SkinSet> sets, std::span<const mat4> matrices);

// All positions, normals and tangents by one affine matrix. If that is singular, normals and tangents
// are dropped: they have no image.
void applyTransform(Geometry&, const mat4& matrix);

}  // namespace quintet::scene
#endif
