// Primitives of glTF meshes as geometries: attributes, indices, all modes that have surfaces, morph
// targets and skins in the rest pose, repairs, tangents.
#ifndef QUINTET_SCENE_GLTF_MESH_H
#define QUINTET_SCENE_GLTF_MESH_H

#include <optional>
#include <string>

#include "scene/gltf_document.h"

namespace quintet::scene {

// What a node does to the mesh that it shows, besides placing it.
struct Deformation {
  std::vector<double> morphWeights;  // empty: the mesh's own
  std::vector<mat4> jointMatrices;   // empty: not skinned
  // Baked into primitives that have no joints (a skinned node's own transform counts only for them), and
  // into all when there are no joint matrices.
  std::optional<mat4> bake;
  bool empty() const { return morphWeights.empty() && jointMatrices.empty() && !bake; }
};

struct GeometryResult {
  std::optional<Geometry> geometry;  // none: nothing with a surface
  std::vector<std::string> ignored;  // lines for the report
  std::vector<std::string> repaired;
};

// Thread-safe. Throws FileError.
GeometryResult readGeometry(const Document&, const std::vector<Material>&, int mesh, int primitive, const Deformation&);

// Weight and target counts over a mesh's primitives; throws FileError.
void checkMorphTargets(const Document&, int mesh);

}  // namespace quintet::scene
#endif
