// SPDX-License-Identifier: Apache-2.0
// Textures whose texture coordinates a geometry does not have. They are ignored: all vertices would show one texel.
#ifndef QUINTET_SCENE_GEOMETRY_TEXTURE_COORDINATES_H
#define QUINTET_SCENE_GEOMETRY_TEXTURE_COORDINATES_H

#include <vector>

#include "scene/model/scene.h"

namespace quintet::scene {

// Bit i: the geometry lacks set i, which a texture of the material uses. The occlusion texture, which no shader reads, does
// not count.
unsigned missingUvSets(const Geometry&, const Material&);

// The material without the textures that use one of these sets.
Material withoutUvSets(Material, unsigned sets);

// A copy of a material for geometries that lack texture coordinates.
struct MaterialCopy {
  int from = kNone;  // indices in Scene::materials
  int copy = kNone;
};

// Gives each geometry that lacks texture coordinates a copy of its material without those textures. Geometries with the same
// material and the same missing sets share one.
std::vector<MaterialCopy> copyMaterialsWithoutUvs(Scene&);

// Lets the animation change the copies like the materials that they were made from.
void animateCopies(NodeAnimation&, const std::vector<MaterialCopy>&);

}  // namespace quintet::scene
#endif
