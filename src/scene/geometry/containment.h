// SPDX-License-Identifier: Apache-2.0
// Whether a point is inside of a solid: a mesh, an analytic solid, or a CSG tree.
#ifndef QUINTET_SCENE_GEOMETRY_CONTAINMENT_H
#define QUINTET_SCENE_GEOMETRY_CONTAINMENT_H

#include <span>

#include "base/math.h"
#include "scene/model/procedural.h"

namespace quintet::scene {

// Generalized winding number (A. Jacobson, L. Kavan and O. Sorkine-Hornung, "Robust Inside-Outside Segmentation using
// Generalized Winding Numbers", 2013): the sum of the signed solid angles of the triangles, divided by 4π. 1 inside of a
// closed mesh whose front faces are outside, 0 outside of it, and in between for meshes with holes. Angles are those of
// A. Van Oosterom and J. Strackee, "The Solid Angle of a Plane Triangle", 1983. Uses all cores.
double windingNumber(std::span<const vec3> positions, std::span<const uvec3> triangles, const glm::dvec3& point);

// `point`: object space. The surface is not inside.
bool contains(const Primitive&, const glm::dvec3& point);
bool contains(const PrimitiveSet&, const CsgTree&, const glm::dvec3& point);

}  // namespace quintet::scene
#endif
