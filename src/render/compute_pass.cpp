// SPDX-License-Identifier: Apache-2.0
#include "render/compute_pass.h"

#include <algorithm>
#include <cassert>

#include "base/error.h"
#include "quintet/shared/pass.h"
#include "shader/library.h"

namespace quintet::render {

std::unique_ptr<gpu::ComputePipeline> makePass(gpu::Context& context, const gpu::BindlessSet& set,
                                               const shader::Compiler& compiler, const std::string& name) {
  const shader::Source source = shader::passSource(name);
  const shader::Result result = compiler.compile(source);
  if (!result.ok())
    throw Error(result.diagnostics.empty() ? source.name + " does not compile" : result.diagnostics[0].format());
  return std::make_unique<gpu::ComputePipeline>(context, set, result.spirv, VK_NULL_HANDLE, name);
}

void dispatchPass(const gpu::ComputePipeline& pass, gpu::Commands& commands, std::span<const std::byte> constants,
                  std::uint32_t count) {
  assert(constants.size() <= shared::kPushConstantBytes);
  const std::uint32_t groups = (count + shared::kPassGroupSize - 1) / shared::kPassGroupSize;
  const std::uint32_t columns = std::min(groups, shared::kPassColumns);
  pass.dispatch(commands, constants, columns, (groups + columns - 1) / columns);
}

}  // namespace quintet::render
