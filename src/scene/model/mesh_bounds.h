// SPDX-License-Identifier: Apache-2.0
// Bounds of one mesh under a transform; scene::worldBounds() returns those of a whole scene.
#ifndef QUINTET_SCENE_MODEL_MESH_BOUNDS_H
#define QUINTET_SCENE_MODEL_MESH_BOUNDS_H

#include "scene/model/scene.h"

namespace quintet::scene {

// Exact: the bounds of all transformed vertices and primitives.
Bounds3 meshBounds(const Mesh& mesh, const mat4& transform);

}  // namespace quintet::scene
#endif
