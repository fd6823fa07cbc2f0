// SPDX-License-Identifier: Apache-2.0
// Bounds of what is visible: vertices that no triangle with an area uses do not count.
#ifndef QUINTET_SCENE_MODEL_MESH_BOUNDS_H
#define QUINTET_SCENE_MODEL_MESH_BOUNDS_H

#include <cstdint>
#include <vector>

#include "scene/model/scene.h"

namespace quintet::scene {

// Of each vertex, whether a triangle with an area uses it; empty if that is so for all. On all cores.
std::vector<std::uint8_t> visibleVertices(const Geometry&);

// Bounds of the visible vertices after `transform`, on all cores. `visible`: visibleVertices().
Bounds3 geometryBounds(const Geometry&, const std::vector<std::uint8_t>& visible, const mat4& transform);

// Bounds of a mesh after `transform`.
Bounds3 meshBounds(const Mesh&, const mat4& transform);

}  // namespace quintet::scene
#endif
