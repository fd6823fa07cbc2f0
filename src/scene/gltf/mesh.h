// SPDX-License-Identifier: Apache-2.0
// Primitives of glTF meshes as geometries: attributes from accessors or Draco, indices, all modes that have a surface,
// morph targets and skins in the rest pose or for an animation, repairs, tangents.
#ifndef QUINTET_SCENE_GLTF_MESH_H
#define QUINTET_SCENE_GLTF_MESH_H

#include <optional>
#include <string>

#include "scene/gltf/document.h"

namespace quintet::scene {

// Changes that a node makes to the vertices of its mesh.
struct Deformation {
  std::vector<double> morphWeights;  // empty means the mesh's own
  std::vector<mat4> jointMatrices;   // empty without a skin
  // Transform baked into primitives without joints (the transform of a skinned node applies only to them), and into all
  // primitives if there are no joint matrices.
  std::optional<mat4> bake;
  // An animation deforms the mesh: GeometryResult::deformation is then set, and the geometry is not deformed; the other
  // members are not used. `jointCount`: of its skin; 0 without one.
  bool animated = false;
  std::size_t jointCount = 0;
};

struct GeometryResult {
  std::optional<Geometry> geometry;  // none if the primitive has no surface
  GeometryDeformation deformation;   // of an animated mesh
  std::vector<std::string> ignored;  // lines for the report
  std::vector<std::string> repaired;
};

// Thread-safe. Throws FileError.
GeometryResult readGeometry(const Document&, const std::vector<Material>&, int mesh, int primitive, const Deformation&);

// Checks that all primitives of a mesh have the same number of morph targets, and the mesh as many weights. Throws
// FileError.
void checkMorphTargets(const Document&, int mesh);

}  // namespace quintet::scene
#endif
