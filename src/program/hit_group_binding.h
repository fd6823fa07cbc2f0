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

// For which geometry a device must call any-hit shaders at most once per intersection, because they can count or multiply
// in the payload. Each value includes the ones before it.
enum class SingleAnyHit {
  tinting,    // geometry that tints light, for the any-hit shaders of the library
  notOpaque,  // all for which any-hit shaders run by default
  all,
};

// Shaders of the program's own need `notOpaque`, or `all` with Program::anyHitForAll.
SingleAnyHit requiredSingleAnyHit(const Program& program);

// Returns the scene as this program sees it: with Program::anyHitForAll, no instance is opaque unless it is forced to be.
SceneFacts factsFor(const Program& program, SceneFacts facts);

}  // namespace quintet::program
#endif
