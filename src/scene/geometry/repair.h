// SPDX-License-Identifier: Apache-2.0
// Repairs of imported numbers: finite positions, unit normals and tangents, rigid frames. The repair functions return
// the number of elements that they replaced.
#ifndef QUINTET_SCENE_GEOMETRY_REPAIR_H
#define QUINTET_SCENE_GEOMETRY_REPAIR_H

#include "scene/model/scene.h"

namespace quintet::scene {

// Drops triangles that have a vertex with a NaN or infinite position, or beyond the largest coordinate (fileTriangles keeps the
// numbers of the others),
// and moves such vertices to a finite position, so that the bounds of all positions are finite.
std::size_t dropNonFiniteTriangles(Geometry&);

// Removes vertices that no triangle uses if they are more than a quarter of all vertices. Files often share one vertex
// buffer among many primitives. The order is kept.
void dropUnusedVertices(Geometry&);

// Normalizes all normals. A normal that is zero or not finite becomes the area-weighted mean of the face normals around
// the vertex; only these are counted.
std::size_t repairNormals(Geometry&);

// Normalizes all tangents and sets w to ±1. A tangent that is zero or not finite becomes some unit vector perpendicular
// to the normal; only these are counted.
std::size_t repairTangents(Geometry&);

// Replaces texture coordinates that are not finite by 0 and colors that are not finite by white. Negative color
// components become 0, which is not counted.
std::size_t repairUvsAndColors(Geometry&);

// A unit vector perpendicular to the unit vector `n` (Duff et al. 2017, "Building an Orthonormal Basis,
// Revisited", JCGT 6(1), listing 3).
vec3 anyPerpendicular(const vec3& n);

// v / |v|, or `fallback` if v is zero or not finite.
vec3 directionOr(const vec3& v, const vec3& fallback);

// The rigid frame with the z axis and, as far as possible, the y axis of `m`. An axis that is zero or not finite is
// replaced by that of the identity.
mat4 rigidFrame(const mat4& m);

}  // namespace quintet::scene
#endif
