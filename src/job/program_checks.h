// SPDX-License-Identifier: Apache-2.0
// Checks programs as `quintet check` does: with all outputs, on their scenes or for any scene, and on request also by a
// short render with checks in the shaders. The result is data; a front end presents it.
#ifndef QUINTET_JOB_PROGRAM_CHECKS_H
#define QUINTET_JOB_PROGRAM_CHECKS_H

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/file.h"
#include "check/check.h"
#include "check/diagram/pipeline_model.h"
#include "check/sources.h"
#include "job/request.h"
#include "program/description/program.h"
#include "program/scene_facts.h"
#include "scene/model/scene.h"
#include "shader/compiler.h"

namespace quintet::job {

struct CheckRequest {
  std::vector<std::string> programs;  // files, built-in names, and folders, which stand for all programs below them
  std::filesystem::path scene;        // empty means each program's own; without one, any scene is assumed
  std::string device;                 // whose limits and driver defects count: limitsOfDevice()
  bool instrument = false;            // also runInstrumented(), if the check finds no error
  RenderRequest run;                  // of the instrumented run; `run.load` also of the check
};

// What the check of one program found.
struct ProgramReport {
  std::string name;                          // as in the request, or the path of a program in a folder
  std::optional<program::Program> program;   // none if its description could not be read
  std::optional<program::SceneFacts> facts;  // none if any scene was assumed
  check::CheckResult result;
  std::vector<std::filesystem::path> files;    // on disk, that the result depends on
  std::map<std::string, std::string> sources;  // texts that SPIR-V modules contain, by file (module_checks.h)
  std::optional<check::PipelineModel> model;   // of raw modules, on request (ModuleCheckRequest::describe)
  bool wrongRequest = false;                   // the program is unknown, or a parameter is invalid
};

struct CheckReport {
  std::vector<ProgramReport> programs;

  // Of all programs, in their order.
  std::vector<Diagnostic> diagnostics() const;
  std::vector<check::SuppressedDiagnostic> suppressed() const;
  check::SourceLookup sources() const;  // this object must outlive it

  // No program has an error, or with `strict` a warning.
  bool passes(bool strict) const;

  bool wrongRequest() const;  // of any program
};

class CheckObserver {
 public:
  virtual ~CheckObserver() = default;

  virtual void started(const std::string& /*name*/) {}            // the check of a program
  virtual void rendering(const program::Program& /*program*/) {}  // its instrumented run; valid until finished()
  virtual void finished(const CheckReport& /*report*/) {}         // the check of the last program of the report
  // A launch did not end in time. The report contains all programs so far, and this as the last diagnostic. A front end
  // should print it and exit without unwinding, as after Observer::deviceHung().
  virtual void hung(const CheckReport& /*report*/) {}
};

// Returns the names with each folder replaced by the programs in it and its subfolders, sorted. Hidden folders and links to
// folders are skipped. A folder without programs stays, so that its check reports it.
std::vector<std::string> findPrograms(const std::vector<std::string>& names);

class ProgramChecks {
 public:
  // `caches`: EngineOptions::caches. Throws gpu::NoDeviceError.
  explicit ProgramChecks(CheckRequest request, const std::filesystem::path& caches = cacheFolder());

  const CheckRequest& request() const { return request_; }

  // Checks what is on disk now. Errors are diagnostics; those without a location have the name of the program as their file
  // and no id. Throws TimeoutError if CheckObserver::hung() returns.
  CheckReport run(CheckObserver& observer) const;

  // Describes how the shaders of a checked program connect. Returns nullopt if it does not compile.
  std::optional<check::PipelineModel> pipelineOf(const ProgramReport& report) const;

 private:
  // The program is the last one of the report.
  void checkProgram(CheckReport& all, CheckObserver& observer) const;
  void checkLoaded(CheckReport& all, CheckObserver& observer) const;
  void addRun(CheckReport& all, scene::Scene scene, CheckObserver& observer) const;

  const CheckRequest request_;
  const std::filesystem::path caches_;
  const shader::Compiler compiler_;
  const check::DeviceLimits limits_;
};

}  // namespace quintet::job
#endif
