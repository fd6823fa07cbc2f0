#include "program/check.h"

#include <algorithm>
#include <chrono>
#include <tuple>

#include "program/check_parts.h"
#include "program/diagnostic_catalog.h"

namespace quintet::program {
namespace {

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void Report::add(std::string_view id, const shader::Place& place, std::string text) {
  const DiagnosticInfo* info = findDiagnostic(id);
  const shader::Severity severity = info ? info->severity : shader::Severity::error;
  const auto same = [&](const shader::Diagnostic& d) {
    return d.id == id && d.file == place.file && d.line == place.line && d.text == text;
  };
  if (std::ranges::any_of(diagnostics_, same)) return;
  diagnostics_.push_back({severity, place.file, place.line, place.column, std::string(id), std::move(text)});
}

bool Report::has(std::string_view id) const {
  return std::ranges::any_of(diagnostics_, [&](const shader::Diagnostic& d) { return d.id == id; });
}

std::vector<shader::Diagnostic> Report::take() {
  std::ranges::stable_sort(diagnostics_, {},
                           [](const shader::Diagnostic& d) { return std::tie(d.id, d.file, d.line); });
  return std::move(diagnostics_);
}

bool CheckResult::ok() const {
  return std::ranges::none_of(diagnostics,
                              [](const shader::Diagnostic& d) { return d.severity == shader::Severity::error; });
}

CheckResult check(const Program& program, const CompiledProgram& compiled, const SceneFacts* scene,
                  const DeviceLimits& limits, bool featureDefines) {
  const auto start = std::chrono::steady_clock::now();
  CheckResult result;
  result.diagnostics = compiled.diagnostics;
  result.recursionDepth = program.declaredRecursion.value_or(1);
  if (compiled.ok) {
    const LinkModel model(program, compiled);
    const std::optional<SceneFacts> opened = scene ? std::optional(factsFor(program, *scene)) : std::nullopt;
    const CheckInput input{model, opened ? &*opened : nullptr, limits, featureDefines};
    Report report;
    checkPayloads(input, report);
    checkPayloadMembers(input, report);
    checkHitAttributes(input, report);
    checkCallables(input, report);
    checkRecursion(input, report, result);
    checkTable(input, report);
    checkFlags(input, report);
    checkGeometry(input, report);
    checkStages(input, report);
    checkUnused(input, report, result);
    for (shader::Diagnostic& d : report.take()) {
      d.file = userFile(program, d.file);
      result.diagnostics.push_back(std::move(d));
    }
  }
  result.seconds = compiled.seconds + secondsSince(start);
  return result;
}

CheckResult check(const Program& program, const shader::Compiler& compiler, const SceneFacts* scene,
                  const DeviceLimits& limits, const std::vector<std::pair<std::string, std::string>>& defines) {
  const bool features =
      std::ranges::any_of(defines, [](const auto& define) { return define.first.starts_with("QUINTET_NO_"); });
  return check(program, compile(program, compiler, defines), scene, limits, features);
}

}  // namespace quintet::program
