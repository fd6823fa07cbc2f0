// SPDX-License-Identifier: Apache-2.0
// The source location of a call from the line that an instrumented shader reports. The shader does not know the file,
// because the call can be in an included one; the debug information of its SPIR-V does.
#ifndef QUINTET_RENDER_RENDERER_TRACE_LOCATION_H
#define QUINTET_RENDER_RENDERER_TRACE_LOCATION_H

#include <cstdint>

#include "base/diagnostic.h"
#include "program/runnable_program.h"

namespace quintet::render {

// Returns the location of the traceRayEXT in the stage number `stage` (of CompiledProgram::stages) that the line belongs
// to. Unknown if there is none, or if files with different names have one.
SourceLocation traceLocation(const program::RunnableProgram& runnable, std::size_t stage, std::uint32_t line);

}  // namespace quintet::render
#endif
