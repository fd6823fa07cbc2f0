// SPDX-License-Identifier: Apache-2.0
// Q718: random numbers that are the same in each sample of a pixel, although the samples are averaged.
//
// A random number is a float that is made of an integer hash, or of fract(sin(x) * large). It is reported if it decides
// on a ray and depends on the pixel, but on no other input, and if the index of the sample (Launch::firstSample, in the
// lecture form frameID) has no influence on any ray of the program.
#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "check/library_names.h"
#include "check/rules/rules.h"
#include "check/rules/user_location.h"
#include "spirv/access.h"
#include "spirv/value_flow.h"

namespace quintet::check {
namespace {

using spirv::Id;
using spv::Op;

constexpr std::uint32_t kLargeFactor = 1u << 10;  // of an integer hash
constexpr double kLargeScale = 100.0;             // of fract(sin(x) * scale)

bool loadsSampleIndex(const spirv::Module& module, const spirv::Instruction& i) {
  const auto member = spirv::bufferMember(module, i);
  return member && libraryName(member->structure) == "Launch" && member->member == "firstSample";
}

// True if the value has the same value in each sample of a pixel: it comes from the launch, the frame or a parameter.
bool isConstantOverSamples(const spirv::Module& module, const spirv::Instruction& load) {
  if (const auto builtIn = spirv::loadedBuiltIn(module, load))
    return *builtIn == spv::BuiltIn::LaunchIdKHR || *builtIn == spv::BuiltIn::LaunchSizeKHR;
  if (spirv::isLocal(module, module.access(load.at(0)).variable)) return true;
  constexpr std::array<std::string_view, 5> kConstant{"Launch", "Frame", "Parameters", "FilmTile", "TileArray"};
  const auto member = spirv::bufferMember(module, load);
  return member && std::ranges::find(kConstant, libraryName(member->structure)) != kConstant.end() &&
         member->member != "previousOutputs";
}

// A scalar constant, or the first component of a constant vector.
std::optional<std::uint32_t> constantBits(const spirv::Module& module, Id value) {
  const spirv::Instruction* i = module.definition(value);
  return i && i->op == Op::OpConstantComposite ? module.constantBits(i->at(0)) : module.constantBits(value);
}

// x * 747796405u
bool mixesBits(const spirv::Module& module, const spirv::Instruction& i) {
  if (i.op != Op::OpIMul) return false;
  const auto a = constantBits(module, i.at(0)), b = constantBits(module, i.at(1));
  return a.value_or(0) >= kLargeFactor || b.value_or(0) >= kLargeFactor;
}

// fract(sin(x) * 43758.5453)
bool isSineHash(const spirv::Module& module, const spirv::Instruction& i) {
  if (!spirv::isExtended(module, i, GLSLstd450Fract)) return false;
  const spirv::Instruction* product = module.definition(i.at(2));
  if (!product || product->op != Op::OpFMul) return false;
  for (const std::size_t k : {0u, 1u}) {
    const spirv::Instruction* sine = module.definition(product->at(k));
    const auto scale = module.constantFloat(product->at(1 - k));
    if (sine && spirv::isExtended(module, *sine, GLSLstd450Sin) && scale && std::abs(*scale) >= kLargeScale)
      return true;
  }
  return false;
}

bool isRandom(const spirv::Module& module, const spirv::Instruction& i) {
  if (isSineHash(module, i)) return true;
  const spirv::Type& type = module.types().get(i.type);
  const auto kind = type.kind == spirv::Type::Kind::vector ? module.types().get(type.element).kind : type.kind;
  const bool converts = i.op == Op::OpConvertUToF || i.op == Op::OpConvertSToF ||
                        (i.op == Op::OpBitcast && kind == spirv::Type::Kind::floating);
  return converts &&
         spirv::dependsOn(module, i.at(0), [&](const spirv::Instruction& k) { return mixesBits(module, k); });
}

// True if the value depends on the pixel and on nothing that differs between its samples.
bool dependsOnPixelOnly(const spirv::Module& module, Id value) {
  const auto loadsPixel = [&](const spirv::Instruction& i) {
    return spirv::loadsBuiltIn(module, i, spv::BuiltIn::LaunchIdKHR);
  };
  const auto varies = [&](const spirv::Instruction& i) {
    if (i.op == Op::OpLoad) return !isConstantOverSamples(module, i) || loadsSampleIndex(module, i);
    const bool image = i.op >= Op::OpSampledImage && i.op <= Op::OpImageQuerySamples;
    return image || i.op == Op::OpReadClockKHR || i.op == Op::OpFunctionCall || i.op == Op::OpFunctionParameter;
  };
  return spirv::dependsOn(module, value, loadsPixel) && !spirv::dependsOn(module, value, varies);
}

// True if the instruction passes a value to another stage.
bool passesOn(const spirv::Module& module, const spirv::Instruction& i) {
  switch (i.op) {
    case Op::OpTraceRayKHR:
    case Op::OpHitObjectTraceRayNV:
    case Op::OpHitObjectExecuteShaderNV:
    case Op::OpExecuteCallableKHR:
    case Op::OpFunctionCall: return true;
    case Op::OpStore: {
      const spirv::Variable* variable = module.variable(module.access(i.at(0)).variable);
      return variable && !spirv::isLocal(module, variable->id);
    }
    default: return false;
  }
}

class RandomSeeds {
 public:
  RandomSeeds(const ProgramInput& input, Report& report)
      : graph_(input.graph), program_(input.program), report_(report) {}

  void check() {
    if (!graph_.error.empty() || !averages()) return;
    for (const PipelineStage& stage : graph_.stages)
      if (stage.facts && usesSampleIndex(stage.facts->module())) return;
    for (const TraceSite& site : graph_.traces)
      if (graph_.stages[site.stage].kind == shader::Stage::rayGeneration) checkTrace(site);
  }

 private:
  // True if the samples of a pixel are averaged: by the film, or by the program with the frame before.
  bool averages() const {
    if (program_.accumulation == program::Accumulation::film)
      return std::ranges::any_of(
          program_.outputs, [](const program::Output& output) { return output.pixel == program::OutputPixel::mean; });
    return std::ranges::any_of(graph_.stages, [](const PipelineStage& stage) {
      if (!stage.facts) return false;
      const spirv::Module& module = stage.facts->module();
      return std::ranges::any_of(module.instructions(), [&](const spirv::Instruction& i) {
        const auto member = spirv::bufferMember(module, i);
        return member && libraryName(member->structure) == "Frame" && member->member == "previousOutputs";
      });
    });
  }

  // True if the index of the sample influences more than the average: a ray, data for another stage, or a branch. The
  // test for the first sample is a part of the average.
  static bool usesSampleIndex(const spirv::Module& module) {
    const auto influences = [&](const spirv::Instruction& i) {
      if (passesOn(module, i) || i.op == Op::OpSwitch) return true;
      return i.op == Op::OpBranchConditional && !testsFirstSample(module, i.at(0));
    };
    return std::ranges::any_of(module.instructions(), [&](const spirv::Instruction& i) {
      return loadsSampleIndex(module, i) && spirv::findInUses(module, i.result, influences) != nullptr;
    });
  }

  // index == 0, index > 0
  static bool testsFirstSample(const spirv::Module& module, Id condition) {
    const spirv::Instruction* i = module.definition(condition);
    if (!i || i->operands.size() != 2) return false;
    return module.constantBits(i->at(0)) == 0u || module.constantBits(i->at(1)) == 0u;
  }

  void checkTrace(const TraceSite& site) {
    const spirv::Module& module = graph_.facts(site).module();
    const auto ray = graph_.ray(site);
    if (!ray) return;
    const auto found = [&](const spirv::Instruction& i) {
      return isRandom(module, i) && dependsOnPixelOnly(module, i.result);
    };
    const spirv::Instruction* random = nullptr;
    for (const Id argument : {ray->origin, ray->direction})
      if (!random) random = spirv::findInSlice(module, argument, found);
    if (random) return add(site, *random);
    if (const spirv::Instruction* seed = seedOf(site)) add(site, *seed);
  }

  // The integer that depends on the pixel and that the ray passes to a shader as seed of its random numbers.
  const spirv::Instruction* seedOf(const TraceSite& site) const {
    const spirv::StageFacts& facts = graph_.facts(site);
    for (const spirv::AccessFacts& write : facts.accesses()) {
      if (!write.writes || write.variable != site.trace->payload) continue;
      for (std::uint32_t leaf = write.leaves.first; leaf < write.leaves.last; ++leaf) {
        const spirv::ValuePart value = facts.storedValue(write, leaf);
        const spirv::Instruction* stored = facts.module().definition(value.id);
        if (!stored || facts.module().types().get(stored->type).kind != spirv::Type::Kind::integer) continue;
        if (!dependsOnPixelOnly(facts.module(), value.id)) continue;
        if (std::ranges::any_of(site.edges, [&](const Edge& edge) { return drawsFrom(edge, leaf); })) return stored;
      }
    }
    return nullptr;
  }

  // True if a shader makes random numbers of the leaf of its payload.
  bool drawsFrom(const Edge& edge, std::uint32_t leaf) const {
    const spirv::StageFacts& facts = graph_.facts(edge);
    const spirv::SharedVariable* payload = facts.incoming(spv::StorageClass::IncomingRayPayloadKHR);
    if (!payload) return false;
    return std::ranges::any_of(facts.module().instructions(), [&](const spirv::Instruction& i) {
      return isRandom(facts.module(), i) && facts.dependsOnLeaf(i.result, payload->id, leaf);
    });
  }

  void add(const TraceSite& site, const spirv::Instruction& source) {
    const spirv::Module& module = graph_.facts(site).module();
    SourceLocation location = site.trace->location;
    if (isLibrary(location)) location = userLocation(module, source).value_or(SourceLocation{});
    const bool lecture = program_.accumulation == program::Accumulation::program;
    report_.addOncePerLine(
        "Q718", graph_.location(graph_.stages[site.stage], location),
        std::string(
            "the random numbers of this ray are the same in each sample: they depend on the pixel, but not on ") +
            (lecture ? "the index of the frame" : "the index of the sample, launch.firstSample"));
  }

  const PipelineGraph& graph_;
  const program::Program& program_;
  Report& report_;
};

}  // namespace

void checkRandomSeeds(const ProgramInput& input, Report& report) { RandomSeeds(input, report).check(); }

}  // namespace quintet::check
