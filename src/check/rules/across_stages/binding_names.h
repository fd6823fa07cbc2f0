// SPDX-License-Identifier: Apache-2.0
// Names in the bindings of hit groups that the scene does not have: misspelled, or of a different scene.
#ifndef QUINTET_CHECK_RULES_BINDING_NAMES_H
#define QUINTET_CHECK_RULES_BINDING_NAMES_H

#include <string>
#include <vector>

#include "program/description/program.h"
#include "program/scene_facts.h"

namespace quintet::check {

struct UnknownName {
  std::size_t group = 0;
  bool material = false;  // else a mesh or primitive set
  std::string name;
  std::string nearest;  // name of the scene that no hit group has; empty if none is near
};

// In the order of the groups; primitives before materials.
std::vector<UnknownName> unknownNames(const program::Program& program, const program::SceneFacts& scene);

// True if the geometry has the nearest name of one of them, so that it uses a wrong hit group until the name is correct.
bool isMisplaced(const program::GeometryFacts& geometry, const std::vector<UnknownName>& names);

}  // namespace quintet::check
#endif
