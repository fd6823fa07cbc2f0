// SPDX-License-Identifier: Apache-2.0
// `quintet check`: compiles programs and checks how their shaders fit together, on a scene; with --watch again after each
// save. Requires a device only with --instrument. With --spirv, checks SPIR-V of other applications.
#include <unistd.h>

#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "base/diagnostic.h"
#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "base/text.h"
#include "check/diagnostic_text.h"
#include "check/diagram/svg.h"
#include "check/sarif.h"
#include "cli/candidates.h"
#include "cli/console.h"
#include "cli/failure.h"
#include "cli/parser.h"
#include "cli/render_options.h"
#include "cli/signals.h"
#include "cli/supervisor.h"
#include "cli/terminal.h"
#include "cli/values.h"
#include "cli/work.h"
#include "job/live_check.h"
#include "job/live_module_check.h"
#include "job/module_checks.h"
#include "job/program_checks.h"
#include "job/scene_source.h"
#include "job/version.h"
#include "output/plan.h"

namespace quintet::cli {
namespace {

struct CheckOptions {
  job::CheckRequest request;
  std::string size, region, samples, timeout;  // of --instrument
  std::filesystem::path sarif, graph;
  bool spirv = false;
  std::filesystem::path groups;  // of --spirv
  std::string colorName = "auto";
  check::TextOptions text;
  bool showSuppressed = false;
  bool watch = false;
  bool json = false;
  LoadTexts load;
  bool strict() const { return request.run.load.strict; }
};

OptionTable declareCheck(CheckOptions& options) {
  OptionTable table("check",
                    "Compiles programs and checks how their shaders fit together and to a scene, without rendering.");
  table.add(
      {{.names = "PROGRAM",
        .help =
            "One or more programs, folders of programs, or built-in names; the last argument can be a scene: .gltf, "
            ".glb or .scene.toml (default: each program's own). With --spirv: SPIR-V files, or folders with them",
        .target = &options.request.programs,
        .candidates = programOrSceneCandidates(),
        .required = true},
       {.names = "--spirv",
        .help = "Check SPIR-V of any application: how the stages of its ray tracing pipelines fit together",
        .target = &options.spirv},
       {.names = "--groups",
        .value = "FILE.json",
        .help = "Shader groups of --spirv in the order of the shader binding table (see docs/layer.md)",
        .target = &options.groups,
        .candidates = {.extensions = {"json"}}},
       {.names = "--json", .help = "Print an array of diagnostics on standard output", .target = &options.json},
       {.names = "--sarif",
        .value = "FILE",
        .help = "Write the diagnostics as SARIF 2.1.0, for editors and CI; - is standard output",
        .target = &options.sarif,
        .candidates = {.names = {"-"}, .extensions = {"sarif"}}},
       {.names = "--graph",
        .value = "FILE",
        .help = "Draw how the shaders connect: .svg, .dot or .json; -.svg is SVG on standard output",
        .target = &options.graph,
        .candidates = {.extensions = {"svg", "dot", "json"}}},
       {.names = "--explain",
        .help = "Also print the page of each diagnostic, as 'quintet explain' does",
        .target = &options.text.explain},
       {.names = "--show-suppressed",
        .help = "List the diagnostics that comments in the sources suppress",
        .target = &options.showSuppressed},
       {.names = "--color",
        .value = "WHEN",
        .help = "Colors in messages: auto (on a terminal), always, never (default: auto)",
        .target = &options.colorName,
        .candidates = {.names = {"auto", "always", "never"}}},
       {.names = "--watch", .help = "Keep running: check again whenever a file is saved", .target = &options.watch},
       {.names = "--instrument",
        .help = "Also render a small image with checks in the shaders (Q001 to Q007)",
        .target = &options.request.instrument},
       {.names = "--size",
        .value = "WxH",
        .help = "Size of the image of --instrument in pixels (default: 96x64)",
        .target = &options.size},
       {.names = "--region",
        .value = "X,Y,W,H",
        .help = "Part of the image of --instrument, in pixels from the top left",
        .target = &options.region},
       {.names = "--spp",
        .value = "N",
        .help = "Number of samples per pixel (default: 4), or of frames (default: 2)",
        .target = &options.samples},
       {.names = "--timeout",
        .value = "SECONDS",
        .help = fmt::format("With --instrument: {}", kLaunchLimitHelp),
        .target = &options.timeout},
       {.names = "--set",
        .value = "NAME=VALUE",
        .help = "Parameter of the program; may be repeated",
        .target = &options.request.run.assignments},
       {.names = "--set-file",
        .value = "FILE.json",
        .help = "Parameters as a JSON object; --set overrides them",
        .target = &options.request.run.parameterFile,
        .candidates = {.extensions = {"json"}}},
       {.names = "--device",
        .value = "NAME",
        .help =
            fmt::format("Device whose limits and driver defects count, and on which --instrument runs. {}; 'none' for "
                        "limits that hold everywhere",
                        kDeviceHelp),
        .target = &options.request.device,
        .candidates = {.names = deviceNames({"none"})}}});
  declareLoading(table, options.load, options.request.run.load,
                 "Exit with status 1 also for warnings, and if a part of the scene file is ignored or repaired");
  table.addExamples({
      {"quintet check my_program/", "its shaders, and how they fit together"},
      {"quintet check my_program/ scene.glb", "and how they fit this scene"},
      {"quintet check my_program/ --watch", "again whenever a file is saved"},
      {"quintet check my_program/ --graph pipeline.svg", "which shader runs which, as an image"},
      {"quintet check my_program/ --json", "for scripts: an array of diagnostics"},
      {"quintet check programs/ --sarif check.sarif", "for editors and CI"},
      {"quintet check programs/ --strict", "all programs; warnings count"},
      {"quintet check --spirv shaders/", "SPIR-V of any application, one pipeline per folder"},
      {"quintet check --spirv shaders/ --groups groups.json", "with its shader groups"},
      {"quintet check my_program/ --instrument", "also find NaN and wrong hit records"},
      {"quintet check my_program/ --instrument --size 1280x720 --region 600,300,64,64", "a part of a larger image"},
  });
  return table;
}

std::string graphExtension(const std::filesystem::path& graph) {
  const std::string name = graph.filename().string();
  return name.substr(std::min(name.rfind('.'), name.size()));
}

// The name for writeFile().
std::filesystem::path outputFile(const std::filesystem::path& file) {
  return output::isStandardOutput(file) ? "-" : file;
}

// The files that the options name. Standard output has room for one of them.
void checkFiles(const CheckOptions& options) {
  if (!options.graph.empty()) {
    const std::string extension = graphExtension(options.graph);
    if (extension != ".svg" && extension != ".dot" && extension != ".json")
      throw UsageError(
          fmt::format("--graph: {}: the file must end in .svg, .dot or .json", printable(options.graph.string())));
  }
  const int outputs = (options.json ? 1 : 0) + (output::isStandardOutput(options.sarif) ? 1 : 0) +
                      (output::isStandardOutput(options.graph) ? 1 : 0);
  if (outputs > 1) throw UsageError("--json, --sarif - and --graph -.svg exclude each other");
}

std::optional<CheckOptions> parseCheck(Arguments arguments) {
  CheckOptions options;
  if (!parse(declareCheck(options), arguments)) return std::nullopt;
  job::CheckRequest& request = options.request;
  job::RenderRequest& run = request.run;
  if (!request.instrument) {
    const auto reject = [](bool given, const char* name) {
      if (given) throw UsageError(fmt::format("{} requires --instrument", name));
    };
    reject(!options.size.empty(), "--size");
    reject(!options.region.empty(), "--region");
    reject(!options.samples.empty(), "--spp");
    reject(!options.timeout.empty(), "--timeout");
    reject(!run.assignments.empty(), "--set");
    reject(!run.parameterFile.empty(), "--set-file");
  }
  if (!options.spirv && !options.groups.empty()) throw UsageError("--groups requires --spirv");
  if (options.spirv) {
    if (request.instrument) throw UsageError("--spirv and --instrument exclude each other");
  }
  convertLoading(options.load, run.load);
  if (!options.size.empty()) run.size = parseSize("--size", options.size);
  if (!options.region.empty()) run.region = parseRegion("--region", options.region);
  run.limits.samples = parseInteger("--spp", options.samples, 1, 1u << 24);
  run.launchTimeout =
      parseReal("--timeout", options.timeout, 0.001, std::numeric_limits<double>::infinity()).value_or(0.0);
  std::vector<std::string>& programs = request.programs;
  if (!options.spirv && !programs.empty() && job::isSceneFile(programs.back())) {
    request.scene = programs.back();
    programs.pop_back();
  }
  if (programs.empty())
    throw UsageError(fmt::format("no {} given; see 'quintet check --help'", options.spirv ? "SPIR-V file" : "program"));
  options.text.color = parseColor(options.colorName);
  options.text.width = terminalWidth(STDERR_FILENO);
  checkFiles(options);
  return options;
}

void writeGraph(const std::filesystem::path& graph, const std::optional<check::PipelineModel>& model, bool spirv) {
  const std::string extension = graphExtension(graph);
  const std::filesystem::path file = outputFile(graph);
  if (!model)
    printMessage(fmt::format("quintet: {}: not written, because {}", printable(graph.string()),
                             spirv ? "a module could not be analyzed" : "the program does not compile"));
  else if (extension == ".json")
    writeFile(file, check::pipelineJson(*model));
  else if (extension == ".dot")
    writeFile(file, check::dotText(check::diagramOf(*model)));
  else
    writeFile(file, check::svgText(check::diagramOf(*model)));
}

// `complete`: the file is not replaced by one with more results.
void writeSarif(const job::CheckReport& report, const CheckOptions& options, bool complete) {
  writeFile(outputFile(options.sarif), check::sarifText(report.diagnostics(), report.suppressed(), report.sources(),
                                                        job::quintetVersion(), complete));
}

// Writes the files that the options request. Returns the exit status.
// `checks` is null for SPIR-V.
int writeReport(const job::CheckReport& report, const job::ProgramChecks* checks, const CheckOptions& options) {
  if (!checks && !options.graph.empty() && report.programs.size() != 1)
    throw UsageError(fmt::format("--graph requires one pipeline, but {} are given", report.programs.size()));
  std::vector<Diagnostic> found = report.diagnostics();
  const std::vector<check::SuppressedDiagnostic> suppressed = report.suppressed();
  int status = report.wrongRequest() ? kWrongCommandLine : report.passes(options.strict()) ? 0 : kRuntimeError;
  try {
    if (!options.sarif.empty()) writeSarif(report, options, true);
    if (!options.graph.empty())
      writeGraph(options.graph, checks ? checks->pipelineOf(report.programs.front()) : report.programs.front().model,
                 !checks);
  } catch (const FileError& error) {
    status = reportFailure(error, FailureJson::none);
    found.push_back(asDiagnostic(error));
  }
  if (options.json) {
    clearWorkResults();
    writeFile("-", check::diagnosticsJson(found, suppressed));
  }
  return status;
}

// Prints what the check of each program found.
class Printer : public job::CheckObserver {
 public:
  Printer(const job::ProgramChecks* checks, const CheckOptions& options) : checks_(checks), options_(options) {}

  void started(const std::string& name) override {
    setWorkProgram(name);
    setWorkStage("checking the program");
  }
  void rendering(const program::Program& program) override {
    setWorkProgram(program.name);
    setWorkStage("rendering with --instrument");
  }
  void hung(const job::CheckReport& report) override {
    finished(report);
    writeReport(report, checks_, options_);
    exitAfterHang(&*report.programs.back().program, report.programs.back().result.diagnostics.back());
  }

  // A crash of the driver in a later program must not lose what was found.
  void finished(const job::CheckReport& all) override {
    const job::ProgramReport& report = all.programs.back();
    if (options_.json)
      addWorkResult(check::diagnosticsJson(report.result.diagnostics, report.result.suppressed));
    else
      print(report, all);
    if (options_.sarif.empty() || output::isStandardOutput(options_.sarif)) return;
    try {
      writeSarif(all, options_, false);
    } catch (const FileError&) {  // writeReport() reports it
    }
  }

 private:
  // Diagnostics and the line "NAME: 1 error, 2 warnings (1 suppressed)".
  void print(const job::ProgramReport& report, const job::CheckReport& all) const {
    const check::CheckResult& result = report.result;
    printError(check::diagnosticsText(
        result.diagnostics, report.program ? check::sourcesOf(*report.program) : all.sources(), options_.text));
    if (options_.showSuppressed) printError(check::suppressedText(result.suppressed, options_.text));
    std::string count = countText(result.diagnostics);
    if (count.empty()) count = "clean";
    if (!result.suppressed.empty()) count += fmt::format(" ({} suppressed)", result.suppressed.size());
    printError(fmt::format("{}: {}\n", printable(report.name), count));
  }

  const job::ProgramChecks* checks_;  // null for SPIR-V
  const CheckOptions& options_;
};

void checkGraph(const CheckOptions& options) {
  if (options.graph.empty()) return;
  const std::size_t count = job::findPrograms(options.request.programs).size();
  if (count != 1) throw UsageError(fmt::format("--graph requires one program, but {} are given", count));
}

// Checks, waits for a saved file, checks again, until Ctrl-C. Returns the last status. `live` is a LiveCheck, or a
// LiveModuleCheck with null `checks`. `prepare` throws UsageError if the options do not fit what is on disk.
template <class Live, class Prepare>
int watch(Live& live, const job::ProgramChecks* checks, const CheckOptions& options, const Prepare& prepare) {
  Printer printer(checks, options);
  const GracefulStop stop;
  int status = 0;
  for (bool canFail = !restartedAfterCrash();; canFail = false) {
    setWatchedFiles(live.watcher().watched());
    try {
      prepare();
      status = writeReport(live.run(printer), checks, options);
    } catch (const Error& error) {  // such as a second program in the folder, with --graph
      if (canFail) throw;
      status = reportFailure(error, FailureJson::none);
    }
    if (canFail && status == kWrongCommandLine) return status;
    setWatchedFiles(live.watcher().watched());
    printMessage(
        fmt::format("watching {}; press Ctrl-C to stop", counted(live.watcher().watched().files.size(), "file")));
    while (!stop.requested() && live.watcher().wait(kSignalSeconds).empty()) {
    }
    if (stop.requested()) return status;
    printMessage(fmt::format("{} saved", live.watcher().changedNames()));
  }
}

int checkSpirv(const CheckOptions& options) {
  const job::ModuleCheckRequest request{options.request.programs, options.groups, options.request.device,
                                        !options.graph.empty()};
  if (options.watch) {
    job::LiveModuleCheck live(request);
    return watch(live, nullptr, options, [] {});
  }
  Printer printer(nullptr, options);
  return writeReport(job::checkModuleFiles(request, printer), nullptr, options);
}

}  // namespace

OptionTable checkOptions() {
  CheckOptions options;
  return declareCheck(options).withoutTargets();
}

int checkCommand(Arguments arguments) {
  const std::optional<CheckOptions> options = parseCheck(arguments);
  if (!options) return 0;
  if (options->spirv) return checkSpirv(*options);
  const job::ProgramChecks checks(options->request);
  if (options->watch) {
    job::LiveCheck live(checks);
    return watch(live, &checks, *options, [&] { checkGraph(*options); });
  }
  checkGraph(*options);
  Printer printer(&checks, *options);
  return writeReport(checks.run(printer), &checks, *options);
}

}  // namespace quintet::cli
