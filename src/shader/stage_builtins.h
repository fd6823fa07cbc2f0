// Which built-in variable and function of GLSL_EXT_ray_tracing exists in which stage, as data, and the compiler's
// messages about the others in words that say so: Q706 for a built-in, Q204 for a hit attribute without a hit.
#ifndef QUINTET_SHADER_STAGE_BUILTINS_H
#define QUINTET_SHADER_STAGE_BUILTINS_H

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shader/compiler.h"

namespace quintet::shader {

struct StageBuiltIn {
  std::string_view name;
  unsigned stages = 0;    // bit 1u << Stage
  bool function = false;  // or a statement such as ignoreIntersectionEXT
  bool availableIn(Stage stage) const { return ((stages >> static_cast<unsigned>(stage)) & 1u) != 0; }
};

// Sorted by name.
std::span<const StageBuiltIn> stageBuiltIns();
const StageBuiltIn* findStageBuiltIn(std::string_view name);  // null: none of ray tracing's

// "any-hit and closest-hit", in the order of Stage.
std::string stagesWith(const StageBuiltIn& builtIn);

// Replaces id and text of messages such as "'gl_HitTEXT' : undeclared identifier" where the stage is the reason.
void explainMissingBuiltIns(std::vector<Diagnostic>& diagnostics, Stage stage);

}  // namespace quintet::shader
#endif
