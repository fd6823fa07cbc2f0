// SPDX-License-Identifier: Apache-2.0
#include "shader/optimizer.h"

#include <string>
#include <string_view>

#include <fmt/format.h>
#include <spirv-tools/libspirv.hpp>
#include <spirv-tools/optimizer.hpp>

#include "base/error.h"
#include "shader/deep_stack.h"

namespace quintet::shader {
namespace {

// Replaces the variables of each function by values. The performance passes do this only after inlining, where the
// construction of SSA form takes more than half of the time, because it grows faster than the function: with this, the
// ray generation shader of the path tracer takes 0.6 instead of 1.5 s.
void registerReductions(spvtools::Optimizer& optimizer) {
  constexpr int kMaxMembers = 100;  // of a structure that is split, as in the performance passes
  optimizer.RegisterPass(spvtools::CreateDeadBranchElimPass())
      .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass())
      .RegisterPass(spvtools::CreateLocalSingleBlockLoadStoreElimPass())
      .RegisterPass(spvtools::CreateLocalSingleStoreElimPass())
      .RegisterPass(spvtools::CreateScalarReplacementPass(kMaxMembers))
      .RegisterPass(spvtools::CreateLocalAccessChainConvertPass())
      .RegisterPass(spvtools::CreateLocalSingleBlockLoadStoreElimPass())
      .RegisterPass(spvtools::CreateLocalSingleStoreElimPass())
      .RegisterPass(spvtools::CreateSSARewritePass())
      .RegisterPass(spvtools::CreateAggressiveDCEPass(false));
}

void registerSpecialization(spvtools::Optimizer& optimizer, const SpecializationValues& values) {
  if (!values.empty()) optimizer.RegisterPass(spvtools::CreateSetSpecConstantDefaultValuePass(values));
  optimizer.RegisterPass(spvtools::CreateFreezeSpecConstantValuePass())
      .RegisterPass(spvtools::CreateFoldSpecConstantOpAndCompositePass());
}

spvtools::ValidatorOptions validatorOptions() {
  spvtools::ValidatorOptions options;
  options.SetFriendlyNames(false);   // making names takes longer than the validation
  options.SetSkipBlockLayout(true);  // it depends on the features of the device
  return options;
}

// Only what the analyses cannot do without: one function in SSA form.
void registerInlining(spvtools::Optimizer& optimizer) {
  optimizer.RegisterPass(spvtools::CreateEliminateDeadFunctionsPass())
      .RegisterPass(spvtools::CreateInlineExhaustivePass())
      .RegisterPass(spvtools::CreateEliminateDeadFunctionsPass())
      .RegisterPass(spvtools::CreateSSARewritePass())
      .RegisterPass(spvtools::CreateAggressiveDCEPass(false));
}

enum class Passes { all, inlining, reductions };

// Runs the passes that `registerPasses(optimizer)` adds. Throws Error if one fails.
template <class Register>
std::vector<std::uint32_t> runPasses(const std::vector<std::uint32_t>& words, const spvtools::OptimizerOptions& options,
                                     const Register& registerPasses) {
  std::vector<std::uint32_t> result;
  std::string message;
  bool succeeded = false;
  runOnDeepStack(stackBytesFor(words.size() * sizeof(std::uint32_t)), [&] {
    spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_3);
    optimizer.SetMessageConsumer([&](spv_message_level_t level, const char*, const spv_position_t&, const char* text) {
      if (level <= SPV_MSG_ERROR) message = text;
    });
    registerPasses(optimizer);
    succeeded = optimizer.Run(words.data(), words.size(), &result, options);
  });
  if (!succeeded) throw Error(fmt::format("spirv-opt failed{}{}", message.empty() ? "" : ": ", message));
  return result;
}

// `untrusted`: validates after each pass. Some passes of SPIRV-Tools 2023.1 make valid modules invalid, with which later passes
// crash (VectorDCE).
std::vector<std::uint32_t> run(const std::vector<std::uint32_t>& words, bool debugInfo, bool untrusted,
                               const std::optional<SpecializationValues>& values, Passes passes = Passes::all) {
  spvtools::OptimizerOptions options;
  options.set_run_validator(passes != Passes::reductions);
  options.set_validator_options(validatorOptions());
  return runPasses(words, options, [&](spvtools::Optimizer& optimizer) {
    optimizer.SetValidateAfterAll(untrusted);
    if (!debugInfo) optimizer.RegisterPass(spvtools::CreateStripDebugInfoPass());
    if (values) registerSpecialization(optimizer, *values);
    if (passes == Passes::inlining)
      registerInlining(optimizer);
    else
      registerReductions(optimizer);
    if (passes == Passes::all) optimizer.RegisterPerformancePasses();
  });
}

// What the constants change in code that is optimized already. Of the ray generation shader of the path tracer for a scene
// without lights, this leaves 1 % more words than the performance passes with the same constants from the start.
void registerRemoval(spvtools::Optimizer& optimizer) {
  optimizer.RegisterPass(spvtools::CreateCCPPass())
      .RegisterPass(spvtools::CreateDeadBranchElimPass())
      .RegisterPass(spvtools::CreateAggressiveDCEPass(false))
      .RegisterPass(spvtools::CreateBlockMergePass())
      .RegisterPass(spvtools::CreateSimplificationPass())
      .RegisterPass(spvtools::CreateIfConversionPass())
      .RegisterPass(spvtools::CreateAggressiveDCEPass(false))
      .RegisterPass(spvtools::CreateRedundancyEliminationPass())
      .RegisterPass(spvtools::CreateVectorDCEPass())
      .RegisterPass(spvtools::CreateDeadBranchElimPass())
      .RegisterPass(spvtools::CreateBlockMergePass())
      .RegisterPass(spvtools::CreateSimplificationPass())
      .RegisterPass(spvtools::CreateAggressiveDCEPass(false));
}

}  // namespace

std::vector<std::uint32_t> specialize(const std::vector<std::uint32_t>& words, const SpecializationValues& values) {
  spvtools::OptimizerOptions options;
  options.set_run_validator(false);
  return runPasses(words, options, [&](spvtools::Optimizer& optimizer) {
    registerSpecialization(optimizer, values);
    registerRemoval(optimizer);
  });
}

std::vector<std::uint32_t> optimize(const std::vector<std::uint32_t>& words, bool debugInfo) {
  return run(words, debugInfo, false, {});
}

std::vector<std::uint32_t> optimizeSpecialized(const std::vector<std::uint32_t>& words,
                                               const std::optional<SpecializationValues>& values) {
  try {
    return run(words, true, true, values);
  } catch (const Error&) {
    if (!validate(words).text.empty()) throw;
    return run(words, true, true, values, Passes::inlining);
  }
}

std::vector<std::uint32_t> draft(const std::vector<std::uint32_t>& words) {
  spvtools::OptimizerOptions options;
  options.set_validator_options(validatorOptions());
  return runPasses(words, options, [&](spvtools::Optimizer& optimizer) {
    optimizer.RegisterPass(spvtools::CreateStripDebugInfoPass());
    registerReductions(optimizer);
  });
}

std::vector<std::uint32_t> reduceUnvalidated(const std::vector<std::uint32_t>& words) {
  return run(words, true, false, {}, Passes::reductions);
}

ValidationProblem validate(const std::vector<std::uint32_t>& words) {
  ValidationProblem problem;
  runOnDeepStack(stackBytesFor(words.size() * sizeof(std::uint32_t)), [&] {
    spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_3);
    tools.SetMessageConsumer([&](spv_message_level_t level, const char*, const spv_position_t& at, const char* text) {
      const std::string_view message = text;
      if (message.find("unrecognized extension") != message.npos) problem.unknown = true;
      if (level > SPV_MSG_ERROR || !problem.text.empty()) return;
      problem.text = message;
      problem.instruction = at.index;
    });
    if (tools.Validate(words.data(), words.size(), validatorOptions())) problem = {};
  });
  // SPIRV-Tools reports what it does not know as an invalid operand or opcode.
  const std::string& text = problem.text;
  const auto has = [&](std::string_view part) { return text.find(part) != text.npos; };
  const std::size_t invalid = text.find("Invalid ");
  problem.unknown = problem.unknown || has("Invalid opcode") || has("nvalid extended instruction") ||
                    has("is not allowed by Vulkan") || has("Invalid SPIR-V binary version") ||
                    (invalid != text.npos && text.find(" operand: ", invalid) != text.npos);
  return problem;
}

}  // namespace quintet::shader
