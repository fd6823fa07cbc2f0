// SPDX-License-Identifier: Apache-2.0
// `quintet check`: compiles programs and checks how their shaders fit together, on a scene. Requires a device only with
// --instrument.
#include <algorithm>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "check/check.h"
#include "check/diagnostic_text.h"
#include "check/scene_facts.h"
#include "cli/candidates.h"
#include "cli/console.h"
#include "cli/parser.h"
#include "cli/values.h"
#include "cli/work.h"
#include "job/device_limits.h"
#include "job/engine.h"
#include "job/instrumented_run.h"
#include "job/scene_source.h"
#include "program/gsn/lecture.h"
#include "program/load.h"

namespace quintet::cli {
namespace {

struct Options {
  std::vector<std::string> positional;  // programs, and possibly a scene
  std::string size, region, samples;    // of --instrument
  std::vector<std::string> programs;
  std::filesystem::path scene;
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
      {"quintet check my_program/ --json", "for editors: an array of diagnostics"},
      {"quintet check programs/ --strict", "all programs; warnings count"},
      {"quintet check my_program/ --instrument", "also find NaN and wrong hit records"},
      {"quintet check my_program/ --instrument --size 1280x720 --region 600,300,64,64", "a part of a larger image"},
  });
  return table;
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
  for (const std::string& name : positional) std::ranges::move(programsOf(name), std::back_inserter(options.programs));
  return options;
}

// On the requested scene or the program's own; without either, what holds for every scene.
std::vector<Diagnostic> checkProgram(const program::Program& program, const shader::Compiler& compiler,
                                     const Options& options, const check::DeviceLimits& limits) {
  const job::SceneSource source = job::chooseSceneSource(options.scene, program);
  const bool hasScene = !options.scene.empty() || !program.scene.empty();
  std::optional<scene::Scene> scene;
  std::optional<program::SceneFacts> facts;
  if (hasScene || options.instrument) scene = job::loadScene(source);
  if (hasScene) facts = check::sceneFacts(*scene);
  std::vector<Diagnostic> found =
      check::checkWithOptionalOutputs(program, compiler, facts ? &*facts : nullptr, limits).diagnostics;
  if (!options.instrument || hasErrors(found)) return found;
  Console console({.json = options.json});
  console.setProgram(&program);
  setWorkStage("rendering with --instrument");
  job::Engine engine({.device = options.device});
  std::ranges::move(job::runInstrumented(engine, program, std::move(*scene), options.run, console),
                    std::back_inserter(found));
  return found;
}

}  // namespace

OptionTable checkOptions() {
  Options options;
  return declare(options).withoutTargets();
}

int checkCommand(Arguments arguments) {
  const std::optional<Options> options = parseOptions(arguments);
  if (!options) return 0;
  const shader::Compiler compiler = job::makeCompiler(cacheFolder());
  const check::DeviceLimits limits = job::limitsOfDevice(options->device);
  std::vector<Diagnostic> all;
  for (const std::string& name : options->programs) {
    std::optional<program::Program> program;
    std::vector<Diagnostic> found;
    setWorkProgram(name);
    setWorkStage("checking the program");
    try {
      program = program::loadProgram(name);
      found = checkProgram(*program, compiler, *options, limits);
    } catch (const FileError& error) {
      found = {asDiagnostic(error)};
    }
    const std::string count = countText(found);
    if (!options->json) {
      printDiagnostics(found, program ? &*program : nullptr, false);
      printError(fmt::format("{}: {}\n", printable(name), count.empty() ? "clean" : count));
    }
    all.insert(all.end(), found.begin(), found.end());
  }
  if (options->json) writeFile("-", check::diagnosticsJson(all));
  const bool warned = std::ranges::find(all, Severity::warning, &Diagnostic::severity) != all.end();
  return hasErrors(all) || (options->strict && warned) ? 1 : 0;
}

}  // namespace quintet::cli
