// SPDX-License-Identifier: Apache-2.0
// Tangent frames for normal maps and anisotropy, if the file has none. The tangent of a vertex is the sum of dP/du of the triangles
// around it, weighted by the corner angle and made perpendicular to the normal (E. Lengyel, "Computing Tangent Space
// Basis Vectors for an Arbitrary Mesh", 2001; Foundations of Game Engine Development 2, section 7.5). MikkTSpace, which
// glTF recommends, also weights by the angle, but sums only within the smooth groups of its own welding. Both agree on
// smooth surfaces.
#ifndef QUINTET_SCENE_GEOMETRY_TANGENTS_H
#define QUINTET_SCENE_GEOMETRY_TANGENTS_H

#include "scene/model/scene.h"

namespace quintet::scene {

// Fills geometry.tangents for the texture coordinate set and the transform of `use`. Does nothing if the normals or
// that set are missing. A vertex whose triangles differ in the handedness of the mapping (a mirrored seam) is
// duplicated.
void generateTangents(Geometry&, const TextureUse& use);

// Generates the tangents that a normal map or the anisotropy of the material requires, if the geometry has none. All of
// them use one frame: that of the normal map, else of the clear coat's normal map, else of the anisotropy texture, else
// of the first texture coordinates. Returns whether the geometry has changed.
bool addTangents(Geometry&, const Material&);
// The same for all geometries with this material of the scene, except those of deformed meshes, whose vertices must
// stay. Returns whether one has changed.
bool addTangents(Scene&, std::size_t material);

// Gives each triangle its own three vertices with the face normal, for a normal map on a flat-shaded geometry.
void splitIntoFlatTriangles(Geometry&);

// u' = translation · rotation · scale · u (KHR_texture_transform).
vec2 transformUv(const TextureUse& use, const vec2& uv);

}  // namespace quintet::scene
#endif
