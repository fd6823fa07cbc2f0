// SPDX-License-Identifier: Apache-2.0
#include "program/probes.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "program/inline_traces.h"
#include "spirv/module.h"
#include "spirv/print_calls.h"
#include "spirv/trace_calls.h"
#include "spirv/value_checks.h"

namespace quintet::program {
namespace {

std::vector<spirv::PrintCall> printCalls(const std::vector<std::uint32_t>& words) {
  if (!spirv::importsDebugPrintf(words)) return {};
  const std::optional<spirv::Module> module = spirv::Module::read(words);
  return module ? spirv::findPrintCalls(*module) : std::vector<spirv::PrintCall>();
}

// The sites of an unoptimized module. Adds a diagnostic for each wrong format.
PrintTable sitesOf(const std::vector<std::uint32_t>& words, const Program& program, const std::string& stage,
                   std::vector<Diagnostic>& diagnostics) {
  PrintTable sites;
  std::optional<spirv::Module> module = spirv::Module::read(words);
  if (!module) return sites;
  for (const auto& [file, text] : program.files) module->addSource(program.path(file), text);
  for (const spirv::PrintCall& call : spirv::findPrintCalls(*module)) {
    SourceLocation location = module->location(module->instructions()[call.instruction], "debugPrintfEXT");
    location.file = userFile(program, location.file);
    try {
      sites.push_back({location, stage, spirv::PrintFormat(call.format, call.arguments)});
    } catch (const Error& error) {
      addUnique(diagnostics,
                {Severity::error, location.file, location.line, location.column, "Q707", error.what(), {}});
    }
  }
  return sites;
}

struct ProbedStage {
  std::size_t index = 0;  // in CompiledProgram::stages
  Probes probes;
  std::uint32_t firstPrint = 0;  // number of its first print
};

// The stages that at least one of the probes applies to.
std::vector<ProbedStage> stagesWith(const CompiledProgram& compiled, Probes probes) {
  std::vector<ProbedStage> stages;
  for (std::size_t i = 0; i < compiled.stages.size(); ++i) {
    const CompiledProgram::Stage& stage = compiled.stages[i];
    Probes own;
    own.prints = probes.prints && !printCalls(stage.spirv).empty();
    own.heat = probes.heat && stage.kind != shader::Stage::callable;  // callable shaders do not trace
    if (own.prints || own.heat) stages.push_back({i, own, 0});
  }
  return stages;
}

}  // namespace

bool prints(const CompiledProgram& compiled) {
  return std::ranges::any_of(compiled.stages, [](const auto& stage) { return !printCalls(stage.spirv).empty(); });
}

PrintTable addProbes(CompiledProgram& compiled, const Program& program, const shader::Compiler& compiler,
                     const std::vector<std::pair<std::string, std::string>>& defines, Instrumentation instrumentation,
                     Probes probes) {
  std::vector<ProbedStage> stages = stagesWith(compiled, probes);
  std::vector<shader::Result> results(stages.size());
  parallelFor(stages.size(), [&](std::size_t k) {
    const ProbedStage& stage = stages[k];
    const std::string& file = compiled.stages[stage.index].file;
    shader::Source source = stageSource(program, file, stage.index, defines, instrumentation);
    if (stage.probes.heat) source.defines = withoutInlineTraces(std::move(source.defines));  // counts calls
    source.text = probedStage(source.text, source.stage, stage.probes, program.accumulation == Accumulation::program,
                              usesLibrary(program, file));
    source.optimize = false;  // the functions of the probes would be inlined
    results[k] = compiler.compile(source);
  });

  PrintTable table;
  std::vector<Diagnostic> diagnostics;
  for (std::size_t k = 0; k < stages.size(); ++k) {
    for (Diagnostic& d : results[k].diagnostics) {
      if (results[k].ok()) break;  // the same warnings as without probes
      d.file = userFile(program, d.file);
      addUnique(diagnostics, std::move(d));
    }
    if (!stages[k].probes.prints) continue;
    stages[k].firstPrint = static_cast<std::uint32_t>(table.size());
    PrintTable sites = sitesOf(results[k].spirv, program, compiled.stages[stages[k].index].file, diagnostics);
    std::ranges::move(sites, std::back_inserter(table));
  }
  if (!diagnostics.empty()) throw ProgramError(std::move(diagnostics));

  parallelFor(stages.size(), [&](std::size_t k) {
    std::vector<std::uint32_t> spirv = std::move(results[k].spirv);
    if (stages[k].probes.prints) spirv = spirv::replacePrintCalls(spirv, stages[k].firstPrint);
    if (stages[k].probes.heat) spirv = spirv::addTraceCalls(spirv);
    compiled.stages[stages[k].index].spirv = compiler.optimize(spirv);
  });
  return table;
}

std::vector<ValueSite> addValueProbes(CompiledProgram& compiled, const Program& program,
                                      const shader::Compiler& compiler,
                                      const std::vector<std::pair<std::string, std::string>>& defines,
                                      Instrumentation instrumentation) {
  const bool accumulates = program.accumulation == Accumulation::program;
  std::vector<shader::Result> results(compiled.stages.size());
  parallelFor(results.size(), [&](std::size_t i) {
    const std::string& file = compiled.stages[i].file;
    shader::Source source = stageSource(program, file, i, defines, instrumentation);
    source.text = probedStage(source.text, source.stage, {.values = true}, accumulates, usesLibrary(program, file));
    source.optimize = false;  // the functions of the probes would be inlined
    results[i] = compiler.compile(source);
  });
  std::vector<ValueSite> sites;
  std::vector<std::uint32_t> firsts;
  std::vector<Diagnostic> diagnostics;
  for (std::size_t i = 0; i < results.size(); ++i) {
    firsts.push_back(static_cast<std::uint32_t>(sites.size()));
    if (!results[i].ok()) {
      for (Diagnostic& d : results[i].diagnostics) {
        d.file = userFile(program, d.file);
        addUnique(diagnostics, std::move(d));
      }
      continue;
    }
    std::optional<spirv::Module> module = spirv::Module::read(results[i].spirv);
    if (!module) continue;
    for (const auto& [file, text] : program.files) module->addSource(program.path(file), text);
    for (const spirv::CheckedValue& value : spirv::findCheckedValues(*module)) {
      SourceLocation location = module->location(module->instructions()[value.instruction]);
      location.file = userFile(program, location.file);
      sites.push_back({std::move(location), compiled.stages[i].file, std::string(value.operation)});
    }
  }
  if (!diagnostics.empty()) throw ProgramError(std::move(diagnostics));
  parallelFor(results.size(), [&](std::size_t i) {
    compiled.stages[i].spirv = compiler.optimize(spirv::addValueChecks(results[i].spirv, firsts[i]));
  });
  return sites;
}

}  // namespace quintet::program
