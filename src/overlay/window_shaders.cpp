// SPDX-License-Identifier: Apache-2.0
#include "overlay/window_shaders.h"

#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/diagnostic.h"
#include "base/embedded.h"
#include "job/engine.h"
#include "shader/compiler.h"

namespace quintet {
std::span<const EmbeddedFile> embeddedWindowShaders();
}

namespace quintet::overlay {
namespace {

std::vector<std::uint32_t> compile(const shader::Compiler& compiler, std::string_view file) {
  for (const EmbeddedFile& embedded : embeddedWindowShaders()) {
    if (embedded.path != file) continue;
    shader::Source source;
    source.stage = *shader::stageOfFile(file);
    source.text = std::string(embedded.data);
    source.name = "<window/" + std::string(file) + ">";
    shader::Result result = compiler.compile(source);
    if (!result.ok()) throw ProgramError(result.diagnostics);
    return std::move(result.spirv);
  }
  return {};
}

}  // namespace

WindowShaders compileWindowShaders(const std::filesystem::path& caches) {
  const shader::Compiler compiler = job::makeCompiler(caches);
  return {compile(compiler, "triangles.vert"), compile(compiler, "triangles.frag")};
}

WindowShaders compileLineShaders(const std::filesystem::path& caches) {
  const shader::Compiler compiler = job::makeCompiler(caches);
  return {compile(compiler, "lines.vert"), compile(compiler, "lines.frag")};
}

}  // namespace quintet::overlay
