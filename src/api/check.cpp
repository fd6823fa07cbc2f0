#include "program/check.h"

#include <algorithm>
#include <iterator>

#include "api/impl.h"
#include "render/scene_facts.h"

namespace quintet {

std::vector<Diagnostic> check(const Program& program, const Scene* scene) {
  const shader::Compiler compiler{shader::CompilerOptions{}};
  std::optional<program::SceneFacts> facts;
  if (scene) facts = render::sceneFacts(scene->impl_->scene);
  const program::CheckResult result =
      program::check(program.impl_->program, compiler, facts ? &*facts : nullptr, program::DeviceLimits{});
  std::vector<Diagnostic> diagnostics;
  std::ranges::transform(result.diagnostics, std::back_inserter(diagnostics), api::toPublic);
  return diagnostics;
}

}  // namespace quintet
