#include "render/program_shaders.h"

#include <utility>

namespace quintet::render {
namespace {

std::string firstError(const std::vector<shader::Diagnostic>& diagnostics) {
  for (const shader::Diagnostic& d : diagnostics)
    if (d.severity == shader::Severity::error) return d.format();
  return "the program does not compile";
}

Defines definesFor(const RenderSettings& settings, const Defines& sceneDefines) {
  Defines defines = settings.defines;
  defines.insert(defines.end(), sceneDefines.begin(), sceneDefines.end());
  for (const std::string& output : settings.outputs) defines.emplace_back("QUINTET_OUTPUT_" + output, "1");
  return defines;
}

}  // namespace

CompiledShaders compileShaders(const program::Program& program, const shader::Compiler& compiler,
                               const RenderSettings& settings, const Defines& sceneDefines) {
  CompiledShaders shaders{definesFor(settings, sceneDefines), {}};
  shaders.program = program::compile(program, compiler, shaders.defines, settings.instrument);
  return shaders;
}

CompiledShaders chooseShaders(const program::Program& program, const shader::Compiler& compiler,
                              const RenderSettings& settings, const Defines& sceneDefines) {
  const bool ready =
      settings.compiled && !settings.instrument && settings.compiled->defines == definesFor(settings, sceneDefines);
  return ready ? *settings.compiled : compileShaders(program, compiler, settings, sceneDefines);
}

ProgramError::ProgramError(std::vector<shader::Diagnostic> diagnostics)
    : Error(firstError(diagnostics)), diagnostics_(std::move(diagnostics)) {}

}  // namespace quintet::render
