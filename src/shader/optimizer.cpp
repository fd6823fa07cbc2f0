// SPDX-License-Identifier: Apache-2.0
#include "shader/optimizer.h"

#include <algorithm>
#include <array>
#include <spirv/unified1/spirv.hpp11>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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

enum class Passes { all, inlining };

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

void registerPasses(spvtools::Optimizer& optimizer, Passes passes) {
  if (passes == Passes::inlining)
    registerInlining(optimizer);
  else
    registerReductions(optimizer);
  if (passes == Passes::all) optimizer.RegisterPerformancePasses();
}

// Runs a pass on a module that need not be valid. Throws Error if it fails.
std::vector<std::uint32_t> runPass(const std::vector<std::uint32_t>& words, const std::string& name) {
  spvtools::OptimizerOptions options;
  options.set_run_validator(false);
  spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_3);
  std::string message;
  optimizer.SetMessageConsumer([&](spv_message_level_t level, const char*, const spv_position_t&, const char* text) {
    if (level <= SPV_MSG_ERROR) message = text;
  });
  std::vector<std::uint32_t> result;
  if (!optimizer.RegisterPassFromFlag("--" + name) || !optimizer.Run(words.data(), words.size(), &result, options))
    throw Error(fmt::format("spirv-opt failed in {}{}{}", name, message.empty() ? "" : ": ", message));
  return result;
}

// What a module has, as far as it decides which passes can change it.
class ModuleContent {
 public:
  explicit ModuleContent(const std::vector<std::uint32_t>& words) {
    constexpr std::size_t kHeader = 5;
    spv::Op last = spv::Op::OpNop, op = spv::Op::OpNop;
    for (std::size_t at = kHeader; at < words.size(); at += std::max(1u, words[at] >> 16)) {
      const auto operand = [&](std::size_t i) { return at + i < words.size() ? words[at + i] : 0; };
      last = std::exchange(op, static_cast<spv::Op>(words[at] & 0xFFFFu));
      switch (op) {
        case spv::Op::OpFunction:
          ++functions_;
          returns_ = 0;
          break;
        case spv::Op::OpReturn:
        case spv::Op::OpReturnValue: ++returns_; break;
        case spv::Op::OpFunctionEnd: hasEarlyReturns_ = hasEarlyReturns_ || returns_ > 1 || !isReturn(last); break;
        case spv::Op::OpKill:
        case spv::Op::OpTerminateInvocation: kills_ = true; break;
        case spv::Op::OpCompositeInsert: inserts_ = true; break;
        case spv::Op::OpPhi: phis_ = true; break;
        case spv::Op::OpLoopMerge: unrolls_ = unrolls_ || (operand(3) & kUnroll) != 0; break;
        case spv::Op::OpVariable:
          locals_ = locals_ || static_cast<spv::StorageClass>(operand(3)) == spv::StorageClass::Function;
          privates_ = privates_ || static_cast<spv::StorageClass>(operand(3)) == spv::StorageClass::Private;
          break;
        default: break;
      }
    }
  }

  // False if the pass has nothing to work on. Building the module for a pass takes longer than most passes.
  bool canChange(std::string_view pass) const {
    if (pass == "wrap-opkill") return kills_;
    if (pass == "merge-return") return hasEarlyReturns_;
    if (pass == "inline-entry-points-exhaustive" || pass == "eliminate-dead-functions") return functions_ > 1;
    if (pass == "private-to-local") return privates_;
    if (pass == "loop-unroll") return unrolls_;
    if (pass == "eliminate-dead-inserts") return inserts_;
    if (pass == "if-conversion") return phis_;
    constexpr std::array<std::string_view, 5> kOfLocals{"eliminate-local-single-block", "eliminate-local-single-store",
                                                        "convert-local-access-chains", "ssa-rewrite",
                                                        "copy-propagate-arrays"};
    if (pass.starts_with("scalar-replacement") || std::ranges::find(kOfLocals, pass) != kOfLocals.end()) return locals_;
    return true;
  }

 private:
  static constexpr auto kUnroll = static_cast<std::uint32_t>(spv::LoopControlMask::Unroll);

  static bool isReturn(spv::Op op) { return op == spv::Op::OpReturn || op == spv::Op::OpReturnValue; }

  std::size_t functions_ = 0;
  std::size_t returns_ = 0;       // of the function that is read
  bool hasEarlyReturns_ = false;  // a function has more than the one at its end
  bool kills_ = false, inserts_ = false, phis_ = false, unrolls_ = false, locals_ = false, privates_ = false;
};

// The passes one by one, with a validation after each that changes the module. Some passes of SPIRV-Tools 2023.1 make valid modules
// invalid, with which later passes crash (VectorDCE). Optimizer::SetValidateAfterAll() would validate three times as often, which
// takes four fifths of the time.
std::vector<std::uint32_t> runUntrusted(const std::vector<std::uint32_t>& words,
                                        const std::optional<SpecializationValues>& values,
                                        Passes passes = Passes::all) {
  spvtools::OptimizerOptions options;
  options.set_run_validator(true);
  options.set_validator_options(validatorOptions());
  std::vector<std::uint32_t> current = runPasses(words, options, [&](spvtools::Optimizer& optimizer) {
    optimizer.SetValidateAfterAll(true);
    if (values) registerSpecialization(optimizer, *values);
  });
  std::string problem;
  runOnDeepStack(stackBytesFor(words.size() * sizeof(std::uint32_t)), [&] {
    spvtools::Optimizer all(SPV_ENV_VULKAN_1_3);
    registerPasses(all, passes);
    spvtools::SpirvTools tools(SPV_ENV_VULKAN_1_3);
    tools.SetMessageConsumer([&](spv_message_level_t level, const char*, const spv_position_t&, const char* text) {
      if (level <= SPV_MSG_ERROR) problem = text;
    });
    const spvtools::ValidatorOptions validator = validatorOptions();
    ModuleContent content(current);
    try {
      for (const char* name : all.GetPassNames()) {
        if (!content.canChange(name)) continue;
        std::vector<std::uint32_t> next = runPass(current, name);
        if (next == current) continue;
        if (!tools.Validate(next.data(), next.size(), validator)) {
          problem = fmt::format("spirv-opt made the module invalid in {}: {}", name, problem);
          return;
        }
        current = std::move(next);
        content = ModuleContent(current);
      }
      problem.clear();
    } catch (const Error& error) {
      problem = error.what();
    }
  });
  if (!problem.empty()) throw Error(problem);
  return current;
}

std::vector<std::uint32_t> run(const std::vector<std::uint32_t>& words, bool debugInfo) {
  spvtools::OptimizerOptions options;
  options.set_run_validator(true);
  options.set_validator_options(validatorOptions());
  return runPasses(words, options, [&](spvtools::Optimizer& optimizer) {
    if (!debugInfo) optimizer.RegisterPass(spvtools::CreateStripDebugInfoPass());
    registerPasses(optimizer, Passes::all);
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
  return run(words, debugInfo);
}

std::vector<std::uint32_t> optimizeSpecialized(const std::vector<std::uint32_t>& words,
                                               const std::optional<SpecializationValues>& values) {
  try {
    return runUntrusted(words, values);
  } catch (const Error&) {
    if (!validate(words).text.empty()) throw;
    return runUntrusted(words, values, Passes::inlining);
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
  spvtools::OptimizerOptions options;
  options.set_run_validator(false);
  return runPasses(words, options, [](spvtools::Optimizer& optimizer) { registerReductions(optimizer); });
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
