// `quintet check`: compiles programs and checks how their shaders fit together, on a scene. Without --instrument it
// needs no device and renders nothing.
#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <optional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "cli.h"
#include "diagnostics_view.h"
#include "gpu/device_choice.h"
#include "instrument.h"
#include "program/check.h"
#include "program/lecture.h"
#include "progress.h"
#include "render/scene_facts.h"
#include "scene_source.h"
#include "values.h"

namespace quintet::app {
namespace {

using shader::Diagnostic;

constexpr const char* kExamples =
    "  quintet check my_program/                  its shaders, and how they fit together\n"
    "  quintet check my_program/ scene.glb        and whether they fit this scene\n"
    "  quintet check my_program/ --json           for editors: an array of diagnostics\n"
    "  quintet check programs/ --strict           all in a folder; a warning is a failure, too\n"
    "  quintet check my_program/ --instrument     and look for NaN, wrong records and self-intersections while it "
    "runs\n";

struct Options {
  std::vector<std::string> programs;
  std::filesystem::path scene;
  std::string device;
  bool json = false;
  bool strict = false;
  bool instrument = false;
};

bool looksLikeScene(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".gltf" || extension == ".glb" || (extension == ".toml" && file.filename() != "program.toml");
}

// The programs in a folder and in those below it.
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

// A folder stands for the programs in it; any other name for itself.
std::vector<std::string> programsOf(const std::string& name) {
  std::vector<std::string> found;
  std::error_code failed;
  if (std::filesystem::is_directory(name, failed)) collectPrograms(name, found);
  std::ranges::sort(found);
  return found.empty() ? std::vector{name} : found;
}

std::optional<Options> parseOptions(Arguments arguments) {
  CLI::App app("Compiles programs and checks how their shaders fit together and to a scene, without rendering.",
               "quintet check");
  Options options;
  std::vector<std::string> positional;
  app.add_option(
         "PROGRAM", positional,
         "One or more programs, folders of programs, or built-in names; last, optionally, a scene: .gltf, .glb or\n"
         ".scene.toml (default: each program's own)")
      ->type_name("");
  app.add_flag("--json", options.json, "An array of diagnostics on standard output");
  app.add_flag("--strict", options.strict, "Warnings count as errors for the exit status");
  app.add_flag("--instrument", options.instrument,
               "Also run a small picture with checks in the shaders (Q001 to Q006)");
  app.add_option(
         "--device", options.device,
         "Whose limits and defects count, and what --instrument runs on: index or\npart of the name; none: no device's")
      ->type_name("NAME");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return std::nullopt;
  if (!positional.empty() && looksLikeScene(positional.back())) {
    options.scene = positional.back();
    positional.pop_back();
  }
  if (positional.empty()) throw UsageError("no program given; see 'quintet check --help'");
  for (const std::string& name : positional) std::ranges::move(programsOf(name), std::back_inserter(options.programs));
  return options;
}

shader::Compiler makeCompiler() {
  shader::CompilerOptions options;
  if (!cacheFolder().empty()) options.cacheFolder = cacheFolder() / "shaders";
  return shader::Compiler(options);
}

// Of the device that `render` would take; without any device what the tested ones have in common.
program::DeviceLimits chooseLimits(const Options& options) {
  if (options.device == "none") return {};
  const std::vector<gpu::DeviceInfo> devices = gpu::Context::devices();
  const char* wanted = std::getenv("QUINTET_DEVICE");
  const std::string request = !options.device.empty() || !wanted ? options.device : wanted;
  if (request.empty() && std::ranges::none_of(devices, &gpu::DeviceInfo::usable)) return {};
  return program::deviceLimits(devices[gpu::chooseDevice(devices, request)]);
}

// With the scene that was asked for or that the program brings; without any, what holds for every scene.
std::vector<Diagnostic> check(const program::Program& program, const shader::Compiler& compiler, const Options& options,
                              const program::DeviceLimits& limits) {
  const SceneSource source = chooseScene(options.scene, program);
  const bool hasScene = !options.scene.empty() || !program.scene.empty();
  std::optional<scene::Scene> scene;
  std::optional<program::SceneFacts> facts;
  if (hasScene || options.instrument) scene = loadScene(source);
  if (hasScene) facts = render::sceneFacts(*scene);
  std::vector<Diagnostic> found = program::check(program, compiler, facts ? &*facts : nullptr, limits).diagnostics;
  if (!options.instrument || hasErrors(found)) return found;
  std::ranges::move(runInstrumented(program, *scene, compiler, options.device), std::back_inserter(found));
  return found;
}

}  // namespace

int checkCommand(Arguments arguments) {
  const std::optional<Options> options = parseOptions(arguments);
  if (!options) return 0;
  const shader::Compiler compiler = makeCompiler();
  const program::DeviceLimits limits = chooseLimits(*options);
  std::vector<Diagnostic> all;
  for (const std::string& name : options->programs) {
    std::vector<Diagnostic> found;
    try {
      const program::Program program = program::loadProgram(name);
      found = check(program, compiler, *options, limits);
      if (!options->json) fmt::print(stderr, "{}", diagnosticsText(found, sourcesOf(program), colorOnStandardError()));
    } catch (const FileError& error) {
      found = {asDiagnostic(error)};
      if (!options->json) fmt::print(stderr, "{}", diagnosticsText(found, sourcesOnDisk(), colorOnStandardError()));
    }
    const std::string count = countText(found);
    if (!options->json) fmt::print(stderr, "{}: {}\n", plain(name), count.empty() ? "clean" : count);
    all.insert(all.end(), found.begin(), found.end());
  }
  if (options->json) writeFile("-", diagnosticsJson(all));
  const bool warned =
      std::ranges::any_of(all, [](const Diagnostic& d) { return d.severity == shader::Severity::warning; });
  return hasErrors(all) || (options->strict && warned) ? 1 : 0;
}

}  // namespace quintet::app
