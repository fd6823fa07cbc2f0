// SPDX-License-Identifier: Apache-2.0
// Tangent frames for normal maps and anisotropy, if the file has none: those of MikkTSpace, which glTF requires for files
// without tangents (M. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008). The steps are:
//   1. Vertices with the same position, normal and texture coordinate are one vertex.
//   2. The triangles around a vertex form groups: those that are connected by edges and have the same orientation of the
//      mapping.
//   3. The tangent of a group is the sum of dP/du of its triangles in the plane of the normal, each of unit length and
//      weighted by the angle of the corner in this plane.
// Triangles without area in the texture connect others and add nothing; if they are between both orientations, they join
// the positive one (MikkTSpace: the first one in the file). The result does not depend on the order of the triangles.
#ifndef QUINTET_SCENE_GEOMETRY_TANGENTS_H
#define QUINTET_SCENE_GEOMETRY_TANGENTS_H

#include "scene/model/scene.h"

namespace quintet::scene {

// Fills geometry.tangents for the texture coordinate set and the transform of `use`. Does nothing if the normals or
// that set are missing. A vertex with several groups, such as on a mirrored seam, is duplicated.
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
