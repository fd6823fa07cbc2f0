// SPDX-License-Identifier: Apache-2.0
// How a program treats the geometry of a scene: which hit group serves it, and for which instances any-hit shaders run.
#ifndef QUINTET_PROGRAM_HIT_GROUP_BINDING_H
#define QUINTET_PROGRAM_HIT_GROUP_BINDING_H

#include <cstddef>

#include "program/description/program.h"
#include "program/scene_facts.h"

namespace quintet::program {

// True if a shader of the group intersects boxes.
bool hasIntersection(const HitGroup& group);

// Returns the index in program.hitGroups of the group that serves a geometry. In order of precedence: the first group
// bound to
//   1. its name (HitGroup::primitives);
//   2. its material, if the group fits: it has an intersection shader for boxes, none for triangles;
//   3. its kind ("triangles", "solids", "csg", "custom");
//   4. "procedural", for boxes;
//   5. its class ("alpha", "thin", "opaque"), if the group fits;
//   6. nothing, if the group fits;
//   7. nothing;
// else 0.
std::size_t hitGroupFor(const Program& program, const GeometryFacts& geometry);

// Returns the scene as this program sees it: with Program::anyHitForAll, no instance is opaque unless it is forced to be.
SceneFacts factsFor(const Program& program, SceneFacts facts);

}  // namespace quintet::program
#endif
