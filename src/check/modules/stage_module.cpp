// SPDX-License-Identifier: Apache-2.0
#include "check/modules/stage_module.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <utility>

#include "base/error.h"
#include "spirv/constant_choices.h"
#include "spirv/plain_code.h"
#include "spirv/plain_lines.h"
#include "spirv/reorder_code.h"

namespace quintet::check {
namespace {

constexpr std::uint32_t swapped(std::uint32_t word) {
  return word << 24 | (word & 0xFF00u) << 8 | (word >> 8 & 0xFF00u) | word >> 24;
}

// True if the entry function does nothing. The optimizer would also remove code that has no effect.
bool hasNoStatements(const std::vector<std::uint32_t>& words) {
  const std::optional<spirv::Module> module = spirv::Module::read(words);
  const spirv::Function* entry = module ? module->entry() : nullptr;
  return entry && std::ranges::all_of(entry->blocks, [&](const spirv::Block& block) {
           for (std::size_t k = block.first; k < block.end; ++k) {
             using spv::Op;
             const spirv::Instruction& i = module->instructions()[k];
             const bool isDebug = i.op == Op::OpExtInst && module->extendedSet(i.at(0)).starts_with("NonSemantic.");
             if (i.op != Op::OpLabel && i.op != Op::OpBranch && i.op != Op::OpReturn && !isDebug) return false;
           }
           return true;
         });
}

}  // namespace

std::vector<std::uint32_t> moduleWords(const std::string& file, std::span<const std::byte> bytes) {
  constexpr std::uint32_t kMagic = spv::MagicNumber;
  std::vector<std::uint32_t> words(bytes.size() / sizeof(std::uint32_t));
  if (!words.empty()) std::memcpy(words.data(), bytes.data(), words.size() * sizeof(std::uint32_t));
  if (words.empty() || (words[0] != kMagic && words[0] != swapped(kMagic)))
    throw FileError(file, "byte 0", "this is not a SPIR-V module");
  if (bytes.size() % sizeof(std::uint32_t) != 0)
    throw FileError(file, "byte " + std::to_string(words.size() * sizeof(std::uint32_t)),
                    "the size is not a multiple of 4 bytes");
  if (words[0] != kMagic) std::ranges::transform(words, words.begin(), swapped);
  return words;
}

std::optional<shader::Stage> stageOf(spv::ExecutionModel model) {
  using Model = spv::ExecutionModel;
  switch (model) {
    case Model::RayGenerationKHR: return shader::Stage::rayGeneration;
    case Model::IntersectionKHR: return shader::Stage::intersection;
    case Model::AnyHitKHR: return shader::Stage::anyHit;
    case Model::ClosestHitKHR: return shader::Stage::closestHit;
    case Model::MissKHR: return shader::Stage::miss;
    case Model::CallableKHR: return shader::Stage::callable;
    default: return {};
  }
}

std::optional<ModuleSummary> summarize(const std::vector<std::uint32_t>& words, std::string& why) {
  const std::optional<spirv::Module> module = spirv::Module::read(words, &why);
  if (!module) return {};
  ModuleSummary summary{{}, module->sources()};
  std::ranges::copy_if(module->entryPoints(), std::back_inserter(summary.entryPoints),
                       [](const spirv::EntryPoint& entry) { return stageOf(entry.stage).has_value(); });
  return summary;
}

ModuleStage stageModule(const std::string& name, const std::vector<std::uint32_t>& words,
                        const spirv::EntryPoint& entryPoint,
                        const std::optional<shader::SpecializationValues>& values) {
  ModuleStage stage{.name = name, .kind = stageOf(entryPoint.stage).value_or(shader::Stage::rayGeneration)};
  constexpr int kMaxUnknown = 64;
  std::vector<std::uint32_t> plain =
      spirv::withPlainCode(spirv::withPlainLines(spirv::withEntryPoint(words, entryPoint)));
  const bool isRewritten = spirv::usesReorderExt(words);
  if (values)
    if (const auto module = spirv::Module::read(plain)) stage.isVariant = spirv::constantsChoose(*module);
  stage.isStub = stage.kind == shader::Stage::intersection && hasNoStatements(plain);
  for (int i = 0; i < kMaxUnknown; ++i) {
    stage.problem.clear();
    try {
      stage.spirv = shader::optimizeSpecialized(plain, values);
      // Some passes leave modules with other extensions unchanged, and a module without its extensions is invalid.
      if (const auto old = spirv::withoutNewExtensions(stage.spirv)) stage.spirv = shader::reduceUnvalidated(*old);
      return stage;
    } catch (const Error& error) {
      const shader::ValidationProblem problem = shader::validate(plain);
      stage.problem = problem.text.empty() ? error.what() : problem.text;
      // SPIRV-Tools cannot judge what was rewritten for it.
      stage.malformed = !problem.text.empty() && !problem.unknown && !isRewritten;
      // What an unknown capability or decoration adds does not matter, unless the module has unknown instructions, too.
      auto reduced = problem.unknown ? spirv::withoutDeclaration(plain, problem.instruction) : std::nullopt;
      if (!reduced) return stage;
      plain = std::move(*reduced);
    }
  }
  return stage;
}

}  // namespace quintet::check
