// SPDX-License-Identifier: Apache-2.0
#include "program/print.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "shader/optimizer.h"
#include "spirv/module.h"
#include "spirv/print_calls.h"

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

}  // namespace

bool prints(const CompiledProgram& compiled) {
  return std::ranges::any_of(compiled.stages, [](const auto& stage) { return !printCalls(stage.spirv).empty(); });
}

PrintTable enablePrints(CompiledProgram& compiled, const Program& program, const shader::Compiler& compiler,
                        const std::vector<std::pair<std::string, std::string>>& defines,
                        Instrumentation instrumentation) {
  std::vector<std::size_t> printing;  // indices of stages
  for (std::size_t i = 0; i < compiled.stages.size(); ++i)
    if (!printCalls(compiled.stages[i].spirv).empty()) printing.push_back(i);

  std::vector<shader::Result> results(printing.size());
  parallelFor(printing.size(), [&](std::size_t k) {
    const std::size_t stage = printing[k];
    shader::Source source = stageSource(program, compiled.stages[stage].file, stage, defines, instrumentation);
    source.text = printingStage(source.text);
    source.optimize = false;  // the functions of quintet/print.glsl would be inlined
    results[k] = compiler.compile(source);
  });

  PrintTable table;
  std::vector<Diagnostic> diagnostics;
  std::vector<std::size_t> firstNumbers;
  for (std::size_t k = 0; k < printing.size(); ++k) {
    for (Diagnostic& d : results[k].diagnostics) {
      if (results[k].ok()) break;
      d.file = userFile(program, d.file);
      addUnique(diagnostics, std::move(d));
    }
    firstNumbers.push_back(table.size());
    PrintTable sites = sitesOf(results[k].spirv, program, compiled.stages[printing[k]].file, diagnostics);
    std::ranges::move(sites, std::back_inserter(table));
  }
  if (!diagnostics.empty()) throw ProgramError(std::move(diagnostics));

  parallelFor(printing.size(), [&](std::size_t k) {
    compiled.stages[printing[k]].spirv = shader::optimize(
        spirv::replacePrintCalls(results[k].spirv, static_cast<std::uint32_t>(firstNumbers[k])));
  });
  return table;
}

}  // namespace quintet::program
