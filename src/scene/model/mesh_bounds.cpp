// SPDX-License-Identifier: Apache-2.0
#include "scene/model/mesh_bounds.h"

namespace quintet::scene {

Bounds3 meshBounds(const Mesh& mesh, const mat4& transform) {
  Bounds3 bounds;
  for (const Geometry& geometry : mesh.geometries)
    for (const vec3& position : geometry.positions) bounds.extend(vec3(transform * vec4(position, 1.0f)));
  for (const PrimitiveSet& set : mesh.primitiveSets) bounds.extend(boundsOf(set, transform));
  return bounds;
}

}  // namespace quintet::scene
