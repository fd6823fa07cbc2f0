// One run of shaderc (glslang and spirv-opt) on a thread with a deep stack.
#ifndef QUINTET_SHADER_GLSLANG_RUN_H
#define QUINTET_SHADER_GLSLANG_RUN_H

#include <functional>

#include "shader/include_resolver.h"

namespace shaderc {
class Compiler;
}

namespace quintet::shader {

struct GlslangRun {
  std::vector<std::uint32_t> spirv;  // empty: failed
  std::vector<Diagnostic> diagnostics;
  // Includes that the preprocessor followed, as (including file, directive); for the check that a
  // cache key covers all of them.
  std::vector<std::pair<std::string, std::string>> includes;
};

GlslangRun runGlslang(const shaderc::Compiler& compiler, const Source& source, const CompilerOptions& options,
                      IncludeResolver& files);

// Calls `body` on a thread with a stack of `bytes` (or the largest that the system grants): glslang
// descends recursively into expressions as deep as the source cares to write. `body` must not throw.
void runOnDeepStack(std::size_t bytes, const std::function<void()>& body);

}  // namespace quintet::shader
#endif
