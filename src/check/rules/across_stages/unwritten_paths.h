// SPDX-License-Identifier: Apache-2.0
// Reads of a payload leaf after a trace that see a shader end the trace without writing the leaf, although a condition on
// the payload guards them: the condition also holds then.
//
//     payload.t = gl_HitTEXT;                                   // closest-hit shader
//     if (gl_PrimitiveID % 2 == 0) payload.metal = 1.0;
//
//     if (payload.t > 0.0) color *= 1.0 - payload.metal;        // tracing stage
#ifndef QUINTET_CHECK_RULES_UNWRITTEN_PATHS_H
#define QUINTET_CHECK_RULES_UNWRITTEN_PATHS_H

#include "spirv/stage_facts.h"

namespace quintet::check {

// One end of a payload: the variable with which a stage traces, or the one that a shader receives.
struct PayloadEnd {
  const spirv::StageFacts& facts;
  spirv::Id variable = 0;
};

// Returns the reads, as indices into StageFacts::accesses() of the tracing stage. `trace` is the instruction.
std::vector<std::size_t> readsOfUnwritten(const PayloadEnd& tracer, std::size_t trace, const PayloadEnd& shader,
                                          std::uint32_t leaf);

}  // namespace quintet::check
#endif
