// SPDX-License-Identifier: Apache-2.0
#include "job/program_checks.h"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "check/scene_facts.h"
#include "gpu/error.h"
#include "job/device_limits.h"
#include "job/engine.h"
#include "job/instrumented_run.h"
#include "job/resolve.h"
#include "job/scene_source.h"
#include "program/lecture/lecture.h"
#include "program/load.h"

namespace quintet::job {
namespace {

namespace fs = std::filesystem;

// The programs in a folder and its subfolders.
void collectPrograms(const fs::path& folder, std::vector<std::string>& found) {
  std::error_code failed;
  if (fs::exists(folder / "program.toml", failed)) {
    found.push_back(folder.string());
    return;
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failed)) {
    const fs::path& path = entry.path();
    if (path.filename().string().starts_with('.')) continue;
    if (path.string().ends_with(program::kLectureExtension)) found.push_back(path.string());
    if (entry.is_directory(failed) && !entry.is_symlink(failed)) collectPrograms(path, found);
  }
}

void addFile(ProgramReport& report, const fs::path& file) {
  std::error_code ignored;
  if (fs::is_regular_file(file, ignored)) report.files.push_back(file);
}

}  // namespace

std::vector<Diagnostic> CheckReport::diagnostics() const {
  std::vector<Diagnostic> all;
  for (const ProgramReport& report : programs) std::ranges::copy(report.result.diagnostics, std::back_inserter(all));
  return all;
}

std::vector<check::SuppressedDiagnostic> CheckReport::suppressed() const {
  std::vector<check::SuppressedDiagnostic> all;
  for (const ProgramReport& report : programs) std::ranges::copy(report.result.suppressed, std::back_inserter(all));
  return all;
}

check::SourceLookup CheckReport::sources() const {
  return [this](const std::string& file) {
    for (const ProgramReport& report : programs) {
      if (const auto found = report.sources.find(file); found != report.sources.end())
        return std::optional(found->second);
      if (report.program)
        if (auto text = check::sourcesOf(*report.program)(file)) return text;
    }
    return check::sourcesOnDisk()(file);
  };
}

bool CheckReport::passes(bool strict) const {
  return std::ranges::none_of(diagnostics(), [strict](const Diagnostic& d) {
    return d.severity == Severity::error || (strict && d.severity == Severity::warning);
  });
}

bool CheckReport::wrongRequest() const { return std::ranges::any_of(programs, &ProgramReport::wrongRequest); }

std::vector<std::string> findPrograms(const std::vector<std::string>& names) {
  std::vector<std::string> programs;
  for (const std::string& name : names) {
    std::vector<std::string> found;
    std::error_code failed;
    if (fs::is_directory(name, failed)) collectPrograms(name, found);
    std::ranges::sort(found);
    if (found.empty()) found.push_back(name);
    std::ranges::move(found, std::back_inserter(programs));
  }
  return programs;
}

ProgramChecks::ProgramChecks(CheckRequest request, const fs::path& caches)
    : request_(std::move(request)),
      caches_(caches),
      compiler_(makeCompiler(caches)),
      limits_(limitsOfDevice(request_.device)) {}

CheckReport ProgramChecks::run(CheckObserver& observer) const {
  CheckReport report;
  for (std::string& name : findPrograms(request_.programs)) {
    report.programs.emplace_back().name = std::move(name);
    checkProgram(report, observer);
  }
  return report;
}

void ProgramChecks::checkProgram(CheckReport& all, CheckObserver& observer) const {
  ProgramReport& report = all.programs.back();
  std::vector<Diagnostic>& diagnostics = report.result.diagnostics;
  observer.started(report.name);
  try {
    report.program = program::loadProgram(report.name);
    checkLoaded(all, observer);
  } catch (const TimeoutError&) {
    throw;
  } catch (const ProgramError& error) {
    for (const Diagnostic& d : error.diagnostics()) addUnique(diagnostics, d);
  } catch (const FileError& error) {
    diagnostics.push_back(asDiagnostic(error));
  } catch (const Error& error) {
    report.wrongRequest = dynamic_cast<const UsageError*>(&error) != nullptr;
    diagnostics.push_back({.file = report.name, .text = error.what()});
  }
  for (const fs::path& file : report.result.files) addFile(report, file);
  for (const Diagnostic& d : diagnostics) addFile(report, d.file);
  if (report.program)
    for (const auto& [file, text] : report.program->files) addFile(report, report.program->path(file));
  observer.finished(all);
}

// On the requested scene or the program's own; without either, what holds for every scene.
void ProgramChecks::checkLoaded(CheckReport& all, CheckObserver& observer) const {
  ProgramReport& report = all.programs.back();
  const program::Program& program = *report.program;
  const SceneSource source = chooseSceneSource(request_.scene, program, request_.run.load);
  const bool hasScene = !request_.scene.empty() || !program.scene.empty();
  report.files = sourceFiles(source);
  std::optional<scene::Scene> scene;
  if (hasScene || request_.instrument) scene = loadScene(source);
  if (scene)
    for (const fs::path& file : scene->report.files) addFile(report, file);
  if (hasScene) report.facts = check::sceneFacts(*scene);
  report.result = check::checkWithOptionalOutputs(program, compiler_, report.facts ? &*report.facts : nullptr, limits_);
  if (request_.instrument && report.result.ok()) addRun(all, std::move(*scene), observer);
}

// What only a run can show.
void ProgramChecks::addRun(CheckReport& all, scene::Scene scene, CheckObserver& observer) const {
  ProgramReport& report = all.programs.back();
  const program::Program& program = *report.program;
  observer.rendering(program);
  for (const program::ImageValue& image : parameterValues(program, request_.run).images())
    if (!image.ofProgram) addFile(report, image.file);
  Engine engine({.device = request_.device, .caches = caches_});
  std::vector<Diagnostic> found =
      runInstrumented(engine, program, std::move(scene), request_.run, [&](const Diagnostic& hang) {
        report.result.diagnostics.push_back(hang);
        observer.hung(all);
      });
  std::ranges::move(check::Suppressions(program).apply(found), std::back_inserter(report.result.suppressed));
  std::ranges::move(found, std::back_inserter(report.result.diagnostics));
}

std::optional<check::PipelineModel> ProgramChecks::pipelineOf(const ProgramReport& report) const {
  if (!report.program) return {};
  return check::describePipeline(*report.program, compiler_, report.facts ? &*report.facts : nullptr, report.result);
}

}  // namespace quintet::job
