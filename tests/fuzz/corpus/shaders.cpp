// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <spirv-tools/libspirv.hpp>

#include "base/error.h"
#include "base/file.h"
#include "check/case_file.h"
#include "program/compile.h"
#include "program/description/parser.h"
#include "program/lecture/lecture.h"
#include "seeds.h"
#include "shader/compiler.h"
#include "shader/stage.h"

namespace quintet::fuzz {
namespace {

namespace fs = std::filesystem;

// Debug information contains the text of the shader, so modules of programs that include the library are much larger.
constexpr std::size_t kMaxBytes = 10'000, kMaxModules = 80;

std::vector<fs::path> filesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

// Libraries in the form of other compilers.
void addModuleSeeds(std::vector<Seed>& seeds, const fs::path& folder) {
  for (const fs::path& file : filesIn(folder)) {
    if (file.extension() != ".spvasm") continue;
    std::vector<std::uint32_t> words;
    if (!spvtools::SpirvTools(SPV_ENV_UNIVERSAL_1_5).Assemble(readTextFile(file), &words))
      throw Error(file.string() + ": cannot be assembled");
    const auto bytes = std::as_bytes(std::span(words));
    seeds.push_back({file.stem().string() + ".spv", {bytes.begin(), bytes.end()}});
  }
}

// Stages with hit objects.
void addReorderSeeds(std::vector<Seed>& seeds, const fs::path& file, const shader::Compiler& compiler) {
  for (const auto& [name, text] : test::readCase(file).files) {
    const auto stage = shader::stageOfFile(name);
    if (!stage) continue;
    shader::Source source;
    source.stage = *stage;
    source.name = name;
    source.text = "#version 460\n#extension GL_EXT_ray_tracing : require\n" + text;
    const shader::Result result = compiler.compile(source);
    if (!result.ok()) throw Error(file.string() + ": " + name + " does not compile");
    const auto bytes = std::as_bytes(std::span(result.spirv));
    seeds.push_back({name + ".spv", {bytes.begin(), bytes.end()}});
  }
}

program::Program programOf(const test::Case& idiom) {
  const auto lecture = idiom.files.find("program.rt.glsl");
  if (lecture != idiom.files.end())
    return program::parseLecture(lecture->second, lecture->first, idiom.name, idiom.files);
  return program::parseProgram(idiom.files.at("program.toml"), idiom.name, idiom.name, idiom.files);
}

}  // namespace

void addSpirvSeeds(Corpora& corpora, const fs::path& root) {
  const shader::Compiler compiler{shader::CompilerOptions{}};
  std::vector<Seed>& seeds = corpora["spirv"];
  for (const fs::path& file : test::casesIn(root / "tests/check/idioms")) {
    const test::Case idiom = test::readCase(file);
    const program::Program program = programOf(idiom);
    for (const program::CompiledProgram::Stage& stage : program::compile(program, compiler, {}).stages) {
      const auto bytes = std::as_bytes(std::span(stage.spirv));
      if (bytes.empty() || bytes.size() > kMaxBytes || seeds.size() >= kMaxModules) continue;
      seeds.push_back({idiom.name + "_" + std::to_string(seeds.size()) + ".spv", {bytes.begin(), bytes.end()}});
    }
  }
  if (seeds.empty()) throw Error("no SPIR-V module is small enough");
  corpora["modules"] = seeds;
  addModuleSeeds(corpora["modules"], root / "tests/check/modules");
  for (const char* engine : {"recorded_hits.case", "reordered_paths.case"})
    addReorderSeeds(corpora["modules"], root / "tests/check/engines" / engine, compiler);
}

}  // namespace quintet::fuzz
