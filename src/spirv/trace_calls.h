// SPDX-License-Identifier: Apache-2.0
// Adds calls of functions around each trace of a module (quintet/heat.glsl).
#ifndef QUINTET_SPIRV_TRACE_CALLS_H
#define QUINTET_SPIRV_TRACE_CALLS_H

#include <cstdint>
#include <vector>

namespace quintet::spirv {

// Calls the module's function heatTraceBegin_ with the flags and the mask of the trace before each traceRayEXT, and heatTraceEnd_ after
// it. Removes the call of heatKeep_, whose purpose is that the compiler keeps the functions. The module must not be
// optimized, or these functions are missing. Throws Error if the module cannot be read or does not have the functions.
std::vector<std::uint32_t> addTraceCalls(const std::vector<std::uint32_t>& words);

}  // namespace quintet::spirv
#endif
