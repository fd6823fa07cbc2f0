// SPDX-License-Identifier: Apache-2.0
// Swapped arguments of traceRayEXT. The graph uses the arguments as intended, so that a swap is reported once (Q508)
// instead of its consequences.
#ifndef QUINTET_CHECK_SWAPPED_ARGUMENTS_H
#define QUINTET_CHECK_SWAPPED_ARGUMENTS_H

#include <string>
#include <string_view>
#include <vector>

#include "spirv/stage_facts.h"

namespace quintet::check {

struct SwappedArguments {
  std::vector<std::string> texts;  // one per swap; empty if no arguments are swapped
  spirv::TraceFacts intended;      // the trace with these arguments exchanged
};

// Finds arguments that are certainly swapped: by the names of the ray flags and of the generated constants in the
// source, or by values that are valid only in the other order.
SwappedArguments findSwappedArguments(const spirv::StageFacts& facts, const spirv::TraceFacts& trace,
                                      std::size_t rayCount);

// Returns the arguments of the call whose name starts at the line and column (1-based), without comments and outer
// spaces; empty if the text has no complete call there.
std::vector<std::string> callArguments(std::string_view text, int line, int column);

}  // namespace quintet::check
#endif
