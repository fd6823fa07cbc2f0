// SPDX-License-Identifier: Apache-2.0
// Q712: an output of the program that no shader stores. Q714: an output that is overwritten, although it is the sum over
// samples, or that gets the mean of the samples.
#include <fmt/format.h>

#include <algorithm>

#include "check/output_access.h"
#include "check/rules/across_stages/shared_data.h"
#include "check/rules/rules.h"
#include "check/rules/user_location.h"
#include "quintet/shared/frame.h"
#include "spirv/access.h"
#include "spirv/source_text.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::Op;

// True if the last member that a load selects has this name.
bool loadsMember(const spirv::Module& module, const spirv::Instruction& load, std::string_view name) {
  if (load.op != Op::OpLoad) return false;
  const auto members = spirv::selectedMembers(module, module.access(load.at(0)));
  return !members.empty() && members.back().name() == name;
}

struct Store {
  const PipelineStage* stage = nullptr;
  std::size_t instruction = 0;
  std::uint32_t slot = 0;
};

class OutputRule {
 public:
  OutputRule(const ProgramInput& input, Report& report)
      : input_(input), graph_(input.graph), program_(input.program), report_(report) {
    for (const PipelineStage& stage : graph_.stages)
      if (stage.facts) collect(stage);
  }

  void check() {
    if (unknown_ || !graph_.error.empty()) return;
    const program::Program& program = program_;
    for (std::uint32_t slot = 0; slot < program.outputs.size(); ++slot) {
      const program::Output& output = program.outputs[slot];
      if (output.isHeatMap) continue;  // a variant of the program stores it
      if (output.optional && std::ranges::find(input_.outputs, output.name) == input_.outputs.end()) continue;
      const bool stored = std::ranges::any_of(stores_, [&](const Store& store) { return store.slot == slot; });
      if (!stored)
        reportMissing(output);
      else if (program.accumulation == program::Accumulation::film && output.pixel == program::OutputPixel::mean)
        checkSum(output, slot), checkMean(output, slot);
    }
  }

 private:
  void collect(const PipelineStage& stage) {
    const spirv::Module& module = stage.facts->module();
    for (std::size_t i = 0; i < module.instructions().size(); ++i) {
      const spirv::Instruction& instruction = module.instructions()[i];
      const auto position = module.position(i);
      if (!position || !stage.facts->flow(position->function).reachable(position->block)) continue;
      const bool atomic = instruction.op >= Op::OpAtomicStore && instruction.op <= Op::OpAtomicXor;
      if (instruction.op == Op::OpFunctionCall) unknown_ = true;
      if (instruction.op != Op::OpStore && instruction.op != Op::OpCopyMemory && !atomic) continue;
      const OutputAccess access = outputOf(module, instruction.at(0));
      if (access.target == OutputTarget::output) stores_.push_back({&stage, i, access.slot});
      unknown_ = unknown_ || access.target == OutputTarget::unknown;
    }
  }

  void reportMissing(const program::Output& output) {
    const PipelineStage* generation = graph_.stage(program_.rayGeneration);
    if (!generation) return;
    const bool lecture = program_.accumulation == program::Accumulation::program && output.line == 0;
    report_.add("Q712", output.line > 0 ? graph_.descriptionLocation(output.line) : mainLocation(graph_, *generation),
                lecture ? std::string("no shader writes the image: the ray generation shader does not call gsnSetPixel")
                        : fmt::format("no shader stores output '{}': there is no storeOutput(kOutput_{}, pixel, sum)",
                                      output.name, output.name));
  }

  bool loadsOutput(const spirv::Module& module, const spirv::Instruction& i, std::uint32_t slot) const {
    if (i.op != Op::OpLoad) return false;
    const OutputAccess access = outputOf(module, i.at(0));
    return access.target == OutputTarget::output && access.slot == slot;
  }

  // Q714: reported if no store to the output adds to its old value.
  void checkSum(const program::Output& output, std::uint32_t slot) {
    const Store* first = nullptr;
    for (const Store& store : stores_) {
      if (store.slot != slot) continue;
      const spirv::Module& module = store.stage->facts->module();
      const spirv::Instruction& instruction = module.instructions()[store.instruction];
      if (instruction.op != Op::OpStore) return;
      const auto loads = [&](const spirv::Instruction& i) { return loadsOutput(module, i, slot); };
      if (spirv::dependsOn(module, instruction.at(1), loads) || dependsOnSample(store)) return;
      if (program_.samplesPerLaunch >= shared::kBatchSamples && !isStoredPerSample(store)) return;
      if (!first) first = &store;
    }
    if (!first) return;
    report_.add("Q714", storeLocation(*first, output.name),
                fmt::format("output '{}' is overwritten: the stored value does not contain the sum so far "
                            "(loadOutput), so of the samples of a batch only the last one counts",
                            output.name));
  }

  // Q714: reported if a launch with several samples divides their sum by their number, as the film does.
  void checkMean(const program::Output& output, std::uint32_t slot) {
    if (program_.samplesPerLaunch == 1) return;
    for (const Store& store : stores_) {
      const spirv::Module& module = store.stage->facts->module();
      const spirv::Instruction& instruction = module.instructions()[store.instruction];
      if (store.slot != slot || instruction.op != Op::OpStore) continue;
      const spirv::Instruction* mean = spirv::findInSlice(
          module, instruction.at(1), [&](const spirv::Instruction& i) { return dividesByCount(module, i); },
          [](const spirv::Instruction& i) { return !isLinear(i.op); });
      const auto location = mean ? userLocation(module, *mean) : std::nullopt;
      if (location)
        report_.addOncePerLine("Q714", graph_.location(*store.stage, *location),
                               fmt::format("output '{}' gets the mean of the samples, but it is their sum: the film "
                                           "divides it by their number again",
                                           output.name));
    }
  }

  // True for instructions that only add, scale and rearrange values.
  static bool isLinear(Op op) {
    switch (op) {
      case Op::OpFAdd:
      case Op::OpFSub:
      case Op::OpFMul:
      case Op::OpFDiv:
      case Op::OpVectorTimesScalar:
      case Op::OpPhi:
      case Op::OpSelect:
      case Op::OpCopyObject:
      case Op::OpCompositeConstruct:
      case Op::OpCompositeExtract:
      case Op::OpCompositeInsert:
      case Op::OpVectorShuffle: return true;
      default: return false;
    }
  }

  // True for x / launch.sampleCount, also as a product, if x comes from the payload of a ray.
  static bool dividesByCount(const spirv::Module& module, const spirv::Instruction& i) {
    if (i.op != Op::OpFDiv && i.op != Op::OpFMul && i.op != Op::OpVectorTimesScalar) return false;
    const auto loadsCount = [&](const spirv::Instruction& load) { return loadsMember(module, load, "sampleCount"); };
    const auto isCount = [&](spirv::Id value) {
      return spirv::dependsOn(module, value, loadsCount, [](const spirv::Instruction& operand) {
        return operand.op != Op::OpConvertUToF && operand.op != Op::OpConvertSToF && operand.op != Op::OpBitcast &&
               operand.op != Op::OpFDiv && operand.op != Op::OpCompositeConstruct;
      });
    };
    const auto isSample = [&](spirv::Id value) {
      return spirv::dependsOn(module, value, [&](const spirv::Instruction& load) {
        if (load.op != Op::OpLoad) return false;
        const spirv::Variable* variable = module.variable(module.access(load.at(0)).variable);
        return variable && variable->storage == spv::StorageClass::RayPayloadKHR;
      });
    };
    return (isCount(i.at(1)) && isSample(i.at(0))) || (i.op == Op::OpFMul && isCount(i.at(0)) && isSample(i.at(1)));
  }

  // True if a condition on the index of the sample decides whether the store runs.
  bool dependsOnSample(const Store& store) const {
    const spirv::Module& module = store.stage->facts->module();
    const auto position = module.position(store.instruction);
    const spirv::ControlFlow& flow = store.stage->facts->flow(position->function);
    const auto loadsIndex = [&](const spirv::Instruction& i) { return loadsMember(module, i, "firstSample"); };
    for (std::size_t b = flow.dominator(position->block); b != spirv::Module::kNone; b = flow.dominator(b)) {
      const spirv::Id condition = flow.condition(b);
      if (condition != 0 && spirv::dependsOn(module, condition, loadsIndex)) return true;
    }
    return false;
  }

  // True if the store is in a loop and stores no sum of that loop.
  bool isStoredPerSample(const Store& store) const {
    const spirv::Module& module = store.stage->facts->module();
    const auto position = module.position(store.instruction);
    const spirv::ControlFlow& flow = store.stage->facts->flow(position->function);
    if (!flow.inLoop(position->block)) return false;
    const auto sums = [&](const spirv::Instruction& i) {
      if (i.op != Op::OpPhi) return false;
      const spirv::Type& type = module.types().get(i.type);
      const spirv::Type& scalar = type.kind == spirv::Type::Kind::vector ? module.types().get(type.element) : type;
      const auto phi = module.position(module.definitionIndex(i.result));
      return scalar.kind == spirv::Type::Kind::floating && phi && phi->function == position->function &&
             startsLoopAround(flow, phi->block, position->block);
    };
    return !spirv::dependsOn(module, module.instructions()[store.instruction].at(1), sums);
  }

  // True if `header` starts a loop that contains the block.
  static bool startsLoopAround(const spirv::ControlFlow& flow, std::size_t header, std::size_t block) {
    if (!flow.dominates(header, block)) return false;
    const auto& blocks = flow.function().blocks;
    std::vector<bool> seen(blocks.size(), false);
    std::vector<std::size_t> open{block};
    while (!open.empty()) {
      const std::size_t next = open.back();
      open.pop_back();
      if (seen[next]) continue;
      seen[next] = true;
      for (const std::size_t successor : blocks[next].successors) {
        if (successor == header && flow.dominates(header, next)) return true;
        if (successor != header) open.push_back(successor);
      }
    }
    return false;
  }

  // The line of storeOutput(kOutput_NAME, …) in the user's file, since the library stores the value.
  SourceLocation storeLocation(const Store& store, const std::string& name) const {
    const spirv::Module& module = store.stage->facts->module();
    for (const auto& [file, ignored] : program_.files) {
      const std::string path = program_.path(file);
      for (const auto& [source, text] : module.sources()) {
        if (!source.ends_with(path)) continue;
        constexpr std::string_view kStore = "storeOutput";
        for (std::size_t at = spirv::findToken(text, kStore); at != text.npos;
             at = spirv::findToken(text, kStore, at + 1)) {
          const std::size_t argument = text.find_first_not_of(" \t(", at + kStore.size());
          const std::size_t start = text.rfind('\n', at) + 1;  // 0 if not found
          const bool comment = text.substr(start, at - start).find("//") != text.npos;
          if (comment || argument == text.npos || spirv::findToken(text, "kOutput_" + name, argument) != argument)
            continue;
          const int line =
              1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
          return {source, line, static_cast<int>(at - start) + 1};
        }
      }
    }
    return mainLocation(graph_, *store.stage);
  }

  const ProgramInput& input_;
  const PipelineGraph& graph_;
  const program::Program& program_;
  Report& report_;
  std::vector<Store> stores_;
  bool unknown_ = false;  // a store can be to any output
};

}  // namespace

void checkOutputs(const ProgramInput& input, Report& report) { OutputRule(input, report).check(); }

}  // namespace quintet::check
