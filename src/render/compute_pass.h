// SPDX-License-Identifier: Apache-2.0
// Compute passes of the shader library (shaders/quintet/passes), with one invocation per element of an array.
#ifndef QUINTET_RENDER_COMPUTE_PASS_H
#define QUINTET_RENDER_COMPUTE_PASS_H

#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "gpu/compute.h"
#include "shader/compiler.h"

namespace quintet::render {

// Compiles quintet/passes/NAME.glsl. Throws Error if it does not compile.
std::unique_ptr<gpu::ComputePipeline> makePass(gpu::Context& context, const gpu::BindlessSet& set,
                                               const shader::Compiler& compiler, const std::string& name);

// Records a dispatch with invocations for `count` elements, in workgroups of shared::kPassGroupSize. `constants`: at most
// shared::kPushConstantBytes.
void dispatchPass(const gpu::ComputePipeline& pass, gpu::Commands& commands, std::span<const std::byte> constants,
                  std::uint32_t count);

}  // namespace quintet::render
#endif
