// Makes a geometry's numbers safe to render: finite positions, unit normals and tangents. Each function
// returns how many elements it had to change.
#ifndef QUINTET_SCENE_REPAIR_H
#define QUINTET_SCENE_REPAIR_H

#include "scene/scene.h"

namespace quintet::scene {

// Drops triangles that have a vertex with a NaN or infinite position (fileTriangles keeps their numbers) and moves such
// vertices onto a finite one, so that boxes over all positions stay finite.
std::size_t dropNonFiniteTriangles(Geometry&);

// Removes vertices that no triangle uses, if they are more than a quarter of all: files often have one vertex
// buffer for many primitives. Keeps the order.
void dropUnusedVertices(Geometry&);

// Normalises all normals. Those that are zero or not finite become the area-weighted mean of the face
// normals around the vertex. The count has only the latter.
std::size_t repairNormals(Geometry&);

// Normalises, sets w to ±1; those that are zero or not finite become any unit vector perpendicular to
// the normal (counted).
std::size_t repairTangents(Geometry&);

// Texture coordinates and colours that are not finite become 0 and white; negative colours become 0.
std::size_t repairUvsAndColors(Geometry&);

// A unit vector perpendicular to the unit vector `n` (Duff et al. 2017, "Building an Orthonormal Basis,
// Revisited", JCGT 6(1), listing 3).
vec3 anyPerpendicular(const vec3& n);

}  // namespace quintet::scene
#endif
