// SPDX-License-Identifier: Apache-2.0
// Q712: an output of the program that no shader stores. Q714: an output that is overwritten, although it is the sum over
// samples. Stores are recognized by their address, which comes from Frame::outputs (shaders/quintet/shared/frame.h).
#include <fmt/format.h>

#include <algorithm>

#include "check/rules/across_stages/shared_data.h"
#include "check/rules/rules.h"
#include "spirv/source_text.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spv::Op;

constexpr std::uint32_t kBatchSamples = 4;  // shaders/quintet/shared/frame.h

bool isChain(const spirv::Instruction& i) { return i.op == Op::OpAccessChain || i.op == Op::OpInBoundsAccessChain; }

// A pointer's access chain: its base and all indices.
struct Chain {
  const spirv::Instruction* base = nullptr;
  std::vector<std::optional<std::uint32_t>> indices;
};

Chain chainOf(const spirv::Module& module, spirv::Id pointer) {
  Chain chain;
  for (int depth = 0; depth < 64; ++depth) {
    chain.base = module.definition(pointer);
    if (!chain.base || (!isChain(*chain.base) && chain.base->op != Op::OpCopyObject)) break;
    std::vector<std::optional<std::uint32_t>> indices;
    for (std::size_t i = 1; isChain(*chain.base) && i < chain.base->operands.size(); ++i)
      indices.push_back(module.constantBits(chain.base->at(i)));
    chain.indices.insert(chain.indices.begin(), indices.begin(), indices.end());
    pointer = chain.base->at(0);
  }
  return chain;
}

// Name of the last structure member on the way, and whether a constant index follows it.
struct MemberAccess {
  std::string name;
  std::optional<std::uint32_t> index;
};

MemberAccess memberOf(const spirv::Module& module, const Chain& chain) {
  MemberAccess result;
  if (!chain.base) return result;
  spirv::Id type = module.types().get(chain.base->type).element;
  for (const std::optional<std::uint32_t>& index : chain.indices) {
    const spirv::Type& at = module.types().get(type);
    if (at.kind == spirv::Type::Kind::structure) {
      if (!index || *index >= at.members.size()) return {};
      result = {at.memberNames[*index], {}};
      type = at.members[*index];
    } else {
      result.index = index;
      type = at.element;
    }
  }
  return result;
}

enum class Target { other, output, unknown };
struct OutputAccess {
  Target target = Target::other;
  std::uint32_t slot = 0;
};

// What a pointer into a buffer points to.
OutputAccess outputOf(const spirv::Module& module, spirv::Id pointer) {
  const spirv::Instruction* access = module.definition(pointer);
  const spirv::Type& type = module.types().get(access ? access->type : 0);
  if (static_cast<spv::StorageClass>(type.storage) != spv::StorageClass::PhysicalStorageBuffer) return {};
  const Chain chain = chainOf(module, pointer);
  const spirv::Instruction* address = chain.base;
  for (int depth = 0; depth < 8 && address; ++depth) {
    if (address->op != Op::OpConvertUToPtr && address->op != Op::OpBitcast && address->op != Op::OpCopyObject) break;
    address = module.definition(address->at(0));
  }
  if (!address || address->op != Op::OpLoad) return {Target::unknown, 0};
  const MemberAccess member = memberOf(module, chainOf(module, address->at(0)));
  if (member.name != "outputs") return {};
  return member.index ? OutputAccess{Target::output, *member.index} : OutputAccess{Target::unknown, 0};
}

struct Store {
  const PipelineStage* stage = nullptr;
  std::size_t instruction = 0;
  std::uint32_t slot = 0;
};

class OutputRule {
 public:
  OutputRule(const CheckInput& input, Report& report) : input_(input), graph_(input.graph), report_(report) {
    for (const PipelineStage& stage : graph_.stages)
      if (stage.facts) collect(stage);
  }

  void check() {
    if (unknown_ || !graph_.error.empty()) return;
    const program::Program& program = graph_.program;
    for (std::uint32_t slot = 0; slot < program.outputs.size(); ++slot) {
      const program::Output& output = program.outputs[slot];
      if (output.optional && std::ranges::find(input_.outputs, output.name) == input_.outputs.end()) continue;
      const bool stored = std::ranges::any_of(stores_, [&](const Store& store) { return store.slot == slot; });
      if (!stored)
        reportMissing(output);
      else if (program.accumulation == program::Accumulation::film && output.pixel == program::OutputPixel::mean)
        checkSum(output, slot);
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
      const spirv::Id pointer = atomic && instruction.op != Op::OpAtomicStore ? instruction.at(0) : instruction.at(0);
      const OutputAccess access = outputOf(module, pointer);
      if (access.target == Target::output) stores_.push_back({&stage, i, access.slot});
      unknown_ = unknown_ || access.target == Target::unknown;
    }
  }

  void reportMissing(const program::Output& output) {
    const PipelineStage* generation = graph_.stage(graph_.program.rayGeneration);
    if (!generation) return;
    const bool lecture = graph_.program.accumulation == program::Accumulation::program && output.line == 0;
    report_.add("Q712", output.line > 0 ? graph_.descriptionLocation(output.line) : mainLocation(graph_, *generation),
                lecture ? std::string("no shader writes the image: the ray generation shader does not call gsnSetPixel")
                        : fmt::format("no shader stores output '{}': storeOutput(kOutput_{}, …) is missing",
                                      output.name, output.name));
  }

  bool loadsOutput(const spirv::Module& module, const spirv::Instruction& i, std::uint32_t slot) const {
    if (i.op != Op::OpLoad) return false;
    const OutputAccess access = outputOf(module, i.at(0));
    return access.target == Target::output && access.slot == slot;
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
      if (graph_.program.samplesPerLaunch >= kBatchSamples && !isStoredPerSample(store)) return;
      if (!first) first = &store;
    }
    if (!first) return;
    report_.add("Q714", storeLocation(*first, output.name),
                fmt::format("output '{}' is overwritten: the stored value does not contain the sum so far "
                            "(loadOutput), so of the samples of a batch only the last one counts",
                            output.name));
  }

  // True if a condition on the index of the sample decides whether the store runs.
  bool dependsOnSample(const Store& store) const {
    const spirv::Module& module = store.stage->facts->module();
    const auto position = module.position(store.instruction);
    const spirv::ControlFlow& flow = store.stage->facts->flow(position->function);
    const auto loadsIndex = [&](const spirv::Instruction& i) {
      return i.op == Op::OpLoad && memberOf(module, chainOf(module, i.at(0))).name == "firstSample";
    };
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
    if (!store.stage->facts->flow(position->function).inLoop(position->block)) return false;
    const auto sums = [&](const spirv::Instruction& i) {
      if (i.op != Op::OpPhi) return false;
      const spirv::Type& type = module.types().get(i.type);
      const spirv::Type& scalar = type.kind == spirv::Type::Kind::vector ? module.types().get(type.element) : type;
      if (scalar.kind != spirv::Type::Kind::floating) return false;
      return spirv::findInUses(module, i.result, [&](const spirv::Instruction& use) { return &use == &i; }) != nullptr;
    };
    return !spirv::dependsOn(module, module.instructions()[store.instruction].at(1), sums);
  }

  // The line of storeOutput(kOutput_NAME, …) in the user's file, since the library stores the value.
  SourceLocation storeLocation(const Store& store, const std::string& name) const {
    const spirv::Module& module = store.stage->facts->module();
    for (const auto& [file, ignored] : graph_.program.files) {
      const std::string path = graph_.program.path(file);
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

  const CheckInput& input_;
  const PipelineGraph& graph_;
  Report& report_;
  std::vector<Store> stores_;
  bool unknown_ = false;  // a store can be to any output
};

}  // namespace

void checkOutputs(const CheckInput& input, Report& report) { OutputRule(input, report).check(); }

}  // namespace quintet::check
