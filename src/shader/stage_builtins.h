// SPDX-License-Identifier: Apache-2.0
// The stages in which each built-in variable and function of GLSL_EXT_ray_tracing exists, and explanations of the
// compiler's messages about the others: Q706 for built-ins, Q204 for hit attributes.
#ifndef QUINTET_SHADER_STAGE_BUILTINS_H
#define QUINTET_SHADER_STAGE_BUILTINS_H

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/diagnostic.h"
#include "shader/stage.h"

namespace quintet::shader {

struct StageBuiltIn {
  std::string_view name;
  unsigned stages = 0;    // bits 1u << Stage
  bool function = false;  // function, or statement such as ignoreIntersectionEXT
  bool availableIn(Stage stage) const { return ((stages >> static_cast<unsigned>(stage)) & 1u) != 0; }
};

// Sorted by name.
std::span<const StageBuiltIn> stageBuiltIns();
const StageBuiltIn* findStageBuiltIn(std::string_view name);  // null if it is not a ray tracing built-in

// Returns the stages as text, "any-hit and closest-hit", in the order of Stage.
std::string stagesWith(const StageBuiltIn& builtIn);

// Replaces id and text of messages such as "'gl_HitTEXT' : undeclared identifier" if the stage is the reason.
void explainMissingBuiltIns(std::vector<Diagnostic>& diagnostics, Stage stage);

}  // namespace quintet::shader
#endif
