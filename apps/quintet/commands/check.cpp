// SPDX-License-Identifier: Apache-2.0
// `quintet check`: compiles programs and checks how their shaders fit together, on a scene; with --watch again after each
// save. Requires a device only with --instrument.
#include <unistd.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/file.h"
#include "base/plural.h"
#include "base/text.h"
#include "check/check.h"
#include "check/diagnostic_text.h"
#include "check/diagram/svg.h"
#include "check/sarif.h"
#include "check/scene_facts.h"
#include "cli/candidates.h"
#include "cli/console.h"
#include "cli/failure.h"
#include "cli/parser.h"
#include "cli/signals.h"
#include "cli/terminal.h"
#include "cli/values.h"
#include "cli/work.h"
#include "job/device_limits.h"
#include "job/engine.h"
#include "job/instrumented_run.h"
#include "job/resolve.h"
#include "job/scene_source.h"
#include "program/gsn/lecture.h"
#include "program/load.h"
#include "shader/file_watcher.h"

namespace quintet::cli {
namespace {

constexpr double kSignalSeconds = 0.25;  // a signal that arrives just before the wait is noticed after this time

struct Options {
  std::vector<std::string> names;       // programs and folders of programs, as given
  std::vector<std::string> positional;  // programs, and possibly a scene
  std::string size, region, samples;    // of --instrument
  std::filesystem::path scene, sarif, graph;
  std::string colorName = "auto";
  check::TextOptions text;
  bool showSuppressed = false;
  bool watch = false;
  std::string device;
  bool json = false;
  bool strict = false;
  bool instrument = false;
  job::RenderRequest run;  // of --instrument
};

// The programs in a folder and its subfolders.
void collectPrograms(const std::filesystem::path& folder, std::vector<std::string>& found) {
  std::error_code failed;
  if (std::filesystem::exists(folder / "program.toml", failed)) {
    found.push_back(folder.string());
    return;
  }
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder, failed)) {
    const std::filesystem::path& path = entry.path();
    if (path.filename().string().starts_with('.')) continue;
    if (path.string().ends_with(program::kLectureExtension)) found.push_back(path.string());
    if (entry.is_directory(failed) && !entry.is_symlink(failed)) collectPrograms(path, found);
  }
}

// Expands a folder to the programs in it.
std::vector<std::string> programsOf(const std::string& name) {
  std::vector<std::string> found;
  std::error_code failed;
  if (std::filesystem::is_directory(name, failed)) collectPrograms(name, found);
  std::ranges::sort(found);
  return found.empty() ? std::vector{name} : found;
}

OptionTable declare(Options& options) {
  OptionTable table("check",
                    "Compiles programs and checks how their shaders fit together and to a scene, without rendering.");
  Candidates candidates = programCandidates();
  candidates.extensions.insert(candidates.extensions.end(), kSceneExtensions.begin(), kSceneExtensions.end());
  table.add(
      {{.names = "PROGRAM",
        .help =
            "One or more programs, folders of programs, or built-in names; the last argument can be a scene: .gltf, "
            ".glb or .scene.toml (default: each program's own)",
        .target = &options.positional,
        .candidates = candidates,
        .required = true},
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
       {.names = "--watch",
        .help = "Keep running: check again whenever a file is saved",
        .target = &options.watch},
       {.names = "--strict", .help = "Exit with status 1 also for warnings", .target = &options.strict},
       {.names = "--instrument",
        .help = "Also render a small image with checks in the shaders (Q001 to Q007)",
        .target = &options.instrument},
       {.names = "--size",
        .value = "WxH",
        .help = "Size of the image of --instrument in pixels (default: 96x64)",
        .target = &options.size},
       {.names = "--region",
        .value = "X,Y,W,H",
        .help = "Part of it to render, in pixels from the top left",
        .target = &options.region},
       {.names = "--spp",
        .value = "N",
        .help = "Number of samples per pixel (default: 4), or of frames (default: 2)",
        .target = &options.samples},
       {.names = "--set",
        .value = "NAME=VALUE",
        .help = "Parameter of the program; may be repeated",
        .target = &options.run.assignments},
       {.names = "--set-file",
        .value = "FILE.json",
        .help = "Parameters as a JSON object; --set overrides them",
        .target = &options.run.parameterFile,
        .candidates = {.extensions = {"json"}}},
       {.names = "--device",
        .value = "NAME",
        .help = "Device whose limits and driver defects count, and on which --instrument runs: index or part of the "
                "name; 'none' for limits that hold everywhere",
        .target = &options.device,
        .candidates = {.names = {"none", "0", "cpu", "gpu", "lavapipe"}}}});
  table.addExamples({
      {"quintet check my_program/", "its shaders, and how they fit together"},
      {"quintet check my_program/ scene.glb", "and how they fit this scene"},
      {"quintet check my_program/ --watch", "again whenever a file is saved"},
      {"quintet check my_program/ --graph pipeline.svg", "which shader runs which, as an image"},
      {"quintet check my_program/ --json", "for scripts: an array of diagnostics"},
      {"quintet check programs/ --sarif check.sarif", "for editors and CI"},
      {"quintet check programs/ --strict", "all programs; warnings count"},
      {"quintet check my_program/ --instrument", "also find NaN and wrong hit records"},
      {"quintet check my_program/ --instrument --size 1280x720 --region 600,300,64,64", "a part of a larger image"},
  });
  return table;
}

std::string graphExtension(const std::filesystem::path& graph) {
  const std::string name = graph.filename().string();
  return name.substr(std::min(name.rfind('.'), name.size()));
}

bool isStandardOutput(const std::filesystem::path& file) { return file == "-" || file.string().starts_with("-."); }

// The files that the options name. Standard output has room for one of them.
void checkFiles(const Options& options) {
  if (!options.graph.empty()) {
    const std::string extension = graphExtension(options.graph);
    if (extension != ".svg" && extension != ".dot" && extension != ".json")
      throw UsageError(fmt::format("--graph: {}: the file must end in .svg, .dot or .json",
                                   printable(options.graph.string())));
  }
  const int outputs = (options.json ? 1 : 0) + (isStandardOutput(options.sarif) ? 1 : 0) +
                      (isStandardOutput(options.graph) ? 1 : 0);
  if (outputs > 1) throw UsageError("--json, --sarif - and --graph -.svg exclude each other");
}

std::optional<Options> parseOptions(Arguments arguments) {
  Options options;
  if (!parse(declare(options), arguments)) return std::nullopt;
  if (!options.instrument) {
    const auto reject = [](bool given, const char* name) {
      if (given) throw UsageError(fmt::format("{} requires --instrument", name));
    };
    reject(!options.size.empty(), "--size");
    reject(!options.region.empty(), "--region");
    reject(!options.samples.empty(), "--spp");
    reject(!options.run.assignments.empty(), "--set");
    reject(!options.run.parameterFile.empty(), "--set-file");
  }
  if (!options.size.empty()) options.run.size = parseSize("--size", options.size);
  if (!options.region.empty()) options.run.region = parseRegion("--region", options.region);
  options.run.limits.samples = parseInteger("--spp", options.samples, 1, 1u << 24);
  std::vector<std::string>& positional = options.positional;
  if (!positional.empty() && job::isSceneFile(positional.back())) {
    options.scene = positional.back();
    positional.pop_back();
  }
  if (positional.empty()) throw UsageError("no program given; see 'quintet check --help'");
  options.names = positional;
  options.text.color = parseColor(options.colorName);
  options.text.width = terminalWidth(STDERR_FILENO);
  checkFiles(options);
  return options;
}

// What the check of a program found.
struct Checked {
  std::string name;
  std::optional<program::Program> program;  // none if its description could not be read
  check::CheckResult result;
  std::optional<program::SceneFacts> facts;
  std::vector<std::filesystem::path> sceneFiles;
};

// On the requested scene or the program's own; without either, what holds for every scene.
void checkProgram(Checked& checked, const shader::Compiler& compiler, const Options& options,
                  const check::DeviceLimits& limits) {
  const program::Program& program = *checked.program;
  const job::SceneSource source = job::chooseSceneSource(options.scene, program);
  const bool hasScene = !options.scene.empty() || !program.scene.empty();
  checked.sceneFiles = job::sourceFiles(source);
  std::optional<scene::Scene> scene;
  if (hasScene || options.instrument) scene = job::loadScene(source);
  if (hasScene) checked.facts = check::sceneFacts(*scene);
  checked.result =
      check::checkWithOptionalOutputs(program, compiler, checked.facts ? &*checked.facts : nullptr, limits);
  if (!options.instrument || !checked.result.ok()) return;
  Console console({.json = options.json});
  console.setProgram(&program);
  setWorkStage("rendering with --instrument");
  job::Engine engine({.device = options.device});
  std::vector<Diagnostic> found = job::runInstrumented(engine, program, std::move(*scene), options.run, console);
  std::ranges::move(check::Suppressions(program).apply(found), std::back_inserter(checked.result.suppressed));
  std::ranges::move(found, std::back_inserter(checked.result.diagnostics));
}

Checked checkByName(const std::string& name, const shader::Compiler& compiler, const Options& options,
                    const check::DeviceLimits& limits) {
  Checked checked;
  checked.name = name;
  setWorkProgram(name);
  setWorkStage("checking the program");
  try {
    checked.program = program::loadProgram(name);
    checkProgram(checked, compiler, options, limits);
  } catch (const FileError& error) {
    checked.result.diagnostics = {asDiagnostic(error)};
  }
  return checked;
}

// Diagnostics and the line "NAME: 1 error, 2 warnings (1 suppressed)".
void print(const Checked& checked, const Options& options) {
  const check::CheckResult& result = checked.result;
  printError(check::diagnosticsText(
      result.diagnostics, checked.program ? check::sourcesOf(*checked.program) : check::sourcesOnDisk(), options.text));
  if (options.showSuppressed) printError(check::suppressedText(result.suppressed, options.text));
  std::string count = countText(result.diagnostics);
  if (count.empty()) count = "clean";
  if (!result.suppressed.empty()) count += fmt::format(" ({} suppressed)", result.suppressed.size());
  printError(fmt::format("{}: {}\n", printable(checked.name), count));
}

void writeGraph(const Checked& checked, const Options& options, const shader::Compiler& compiler) {
  const std::string extension = graphExtension(options.graph);
  const std::filesystem::path file = isStandardOutput(options.graph) ? "-" : options.graph;
  std::optional<check::PipelineModel> model;
  if (checked.program)
    model = check::describePipeline(*checked.program, compiler, checked.facts ? &*checked.facts : nullptr,
                                    checked.result);
  if (!model)
    printMessage(fmt::format("quintet: {}: not written, because the program does not compile",
                             printable(options.graph.string())));
  else if (extension == ".json")
    writeFile(file, check::pipelineJson(*model));
  else if (extension == ".dot")
    writeFile(file, check::dotText(check::diagramOf(*model)));
  else
    writeFile(file, check::svgText(check::diagramOf(*model)));
}

// Checks the programs in the order of the command line.
class ProgramChecks {
 public:
  explicit ProgramChecks(const Options& options)
      : options_(options),
        compiler_(job::makeCompiler(cacheFolder())),
        limits_(job::limitsOfDevice(options.device)) {}

  // Returns the exit status.
  int run() {
    std::vector<std::string> names;
    for (const std::string& name : options_.names) std::ranges::move(programsOf(name), std::back_inserter(names));
    if (!options_.graph.empty() && names.size() != 1)
      throw UsageError(fmt::format("--graph requires one program, but {} are given", names.size()));
    checked_.clear();
    for (const std::string& name : names) {
      checked_.push_back(checkByName(name, compiler_, options_, limits_));
      if (!options_.json) print(checked_.back(), options_);
    }
    std::vector<Diagnostic> all;
    std::vector<check::SuppressedDiagnostic> suppressed;
    for (const Checked& checked : checked_) {
      const check::CheckResult& result = checked.result;
      all.insert(all.end(), result.diagnostics.begin(), result.diagnostics.end());
      suppressed.insert(suppressed.end(), result.suppressed.begin(), result.suppressed.end());
    }
    if (options_.json) writeFile("-", check::diagnosticsJson(all, suppressed));
    if (!options_.sarif.empty()) writeFile(options_.sarif, check::sarifText(all, suppressed, sources(), QUINTET_VERSION));
    if (!options_.graph.empty()) writeGraph(checked_.front(), options_, compiler_);
    const bool warned = std::ranges::find(all, Severity::warning, &Diagnostic::severity) != all.end();
    return hasErrors(all) || (options_.strict && warned) ? kRuntimeError : 0;
  }

  // Watches all files that the last run has read, and the folders of the programs. Returns the number of files.
  std::size_t watch(shader::FileWatcher& watcher) const {
    std::vector<std::filesystem::path> files, folders;
    if (!options_.scene.empty()) files.push_back(options_.scene);
    if (!options_.run.parameterFile.empty()) files.push_back(options_.run.parameterFile);
    std::error_code ignored;
    const auto add = [&](const std::filesystem::path& file) {
      if (std::filesystem::is_regular_file(file, ignored) && std::ranges::find(files, file) == files.end())
        files.push_back(file);
    };
    for (const std::string& name : options_.names) {
      add(name);
      if (std::filesystem::is_directory(name, ignored)) folders.emplace_back(name);
    }
    for (const Checked& checked : checked_) {
      if (std::filesystem::is_directory(checked.name, ignored)) folders.emplace_back(checked.name);
      for (const std::filesystem::path& file : checked.sceneFiles) add(file);
      for (const std::filesystem::path& file : checked.result.files) add(file);
      for (const Diagnostic& d : checked.result.diagnostics) add(d.file);
      if (!checked.program) continue;
      for (const auto& [file, text] : checked.program->files) add(checked.program->path(file));
    }
    watcher.watch(files, folders, job::isProgramSource);
    return files.size();
  }

 private:
  // Of all programs.
  check::SourceLookup sources() const {
    return [this](const std::string& file) {
      for (const Checked& checked : checked_)
        if (checked.program)
          if (auto text = check::sourcesOf(*checked.program)(file)) return text;
      return check::sourcesOnDisk()(file);
    };
  }

  const Options& options_;
  const shader::Compiler compiler_;
  const check::DeviceLimits limits_;
  std::vector<Checked> checked_;
};

// Checks, waits for a saved file, checks again, until Ctrl-C. Returns the last status.
int watchPrograms(ProgramChecks& checks) {
  shader::FileWatcher watcher;
  const GracefulStop stop;
  const auto printEnd = [&] {
    printMessage(fmt::format("watching {}; press Ctrl-C to stop", counted(checks.watch(watcher), "file")));
  };
  checks.watch(watcher);  // a save during the first check counts
  int status = checks.run();
  printEnd();
  while (!stop.requested()) {
    const std::vector<std::filesystem::path> changed = watcher.wait(kSignalSeconds);
    if (changed.empty()) continue;
    std::vector<std::string> names;
    for (const std::filesystem::path& file : changed) names.push_back(file.filename().string());
    printMessage(printable(fmt::format("{} saved", fmt::join(names, ", "))));
    try {
      status = checks.run();
    } catch (const Error& error) {  // such as a program that was removed
      status = reportFailure(error, false);
    }
    printEnd();
  }
  return status;
}

}  // namespace

OptionTable checkOptions() {
  Options options;
  return declare(options).withoutTargets();
}

int checkCommand(Arguments arguments) {
  const std::optional<Options> options = parseOptions(arguments);
  if (!options) return 0;
  ProgramChecks checks(*options);
  return options->watch ? watchPrograms(checks) : checks.run();
}

}  // namespace quintet::cli
