// The shaders of a program for a scene: compiled with the definitions that scene and settings ask for.
#ifndef QUINTET_RENDER_PROGRAM_SHADERS_H
#define QUINTET_RENDER_PROGRAM_SHADERS_H

#include <vector>

#include "base/error.h"
#include "program/link.h"
#include "render/render_settings.h"
#include "render/scene_features.h"

namespace quintet::render {

// A program's GLSL as SPIR-V, and for what it was compiled.
struct CompiledShaders {
  Defines defines;
  program::CompiledProgram program;
};

// Compiles the program for a scene that is not on the device yet. `sceneDefines`: shaderDefines() of it. What is wrong with
// the program stands in the result.
CompiledShaders compileShaders(const program::Program& program, const shader::Compiler& compiler,
                               const RenderSettings& settings, const Defines& sceneDefines);

// Those of the settings, if they are what the scene on the device wants; else compiles.
CompiledShaders chooseShaders(const program::Program& program, const shader::Compiler& compiler,
                              const RenderSettings& settings, const Defines& sceneDefines);

// A program whose shaders do not compile or do not fit together (program/check.h); what() is the first error's line.
class ProgramError : public Error {
 public:
  explicit ProgramError(std::vector<shader::Diagnostic> diagnostics);
  const std::vector<shader::Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<shader::Diagnostic> diagnostics_;
};

}  // namespace quintet::render
#endif
