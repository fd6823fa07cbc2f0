// `quintet check`: compiles programs and checks how their shaders fit together, on a scene; renders nothing.
#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "cli.h"
#include "diagnostics_view.h"
#include "program/link.h"
#include "progress.h"
#include "render/scene_features.h"
#include "scene_setup.h"
#include "scene_source.h"
#include "values.h"

namespace quintet::app {
namespace {

using shader::Diagnostic;

constexpr const char* kExamples =
    "  quintet check my_program/                  its shaders, and how they fit together\n"
    "  quintet check my_program/ scene.glb        and whether they fit this scene\n"
    "  quintet check my_program/ --json           for editors: an array of diagnostics\n"
    "  quintet check programs/* --strict          several; a warning is a failure, too\n";

struct Options {
  std::vector<std::string> programs;
  std::filesystem::path scene;
  bool json = false;
  bool strict = false;
};

bool looksLikeScene(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".gltf" || extension == ".glb" || (extension == ".toml" && file.filename() != "program.toml");
}

std::optional<Options> parseOptions(Arguments arguments) {
  CLI::App app("Compiles programs and checks how their shaders fit together and to a scene, without rendering.",
               "quintet check");
  Options options;
  std::vector<std::string> positional;
  app.add_option("PROGRAM", positional, "One or more folders or built-in names; last, optionally, a scene: .gltf, .glb or\n"
                                        ".scene.toml (default: each program's own)")
      ->type_name("");
  app.add_flag("--json", options.json, "An array of diagnostics on standard output");
  app.add_flag("--strict", options.strict, "Warnings count as errors for the exit status");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return std::nullopt;
  if (!positional.empty() && looksLikeScene(positional.back())) {
    options.scene = positional.back();
    positional.pop_back();
  }
  if (positional.empty()) throw UsageError("no program given; see 'quintet check --help'");
  options.programs = std::move(positional);
  return options;
}

shader::Compiler makeCompiler() {
  shader::CompilerOptions options;
  if (!cacheFolder().empty()) options.cacheFolder = cacheFolder() / "shaders";
  return shader::Compiler(options);
}

std::vector<Diagnostic> check(const program::Program& program, const shader::Compiler& compiler, const Options& options) {
  std::vector<std::pair<std::string, std::string>> defines;
  const SceneSource source = chooseScene(options.scene, program);
  if (!source.file.empty()) {
    const scene::Scene scene = loadScene(source);
    defines = render::featureDefines(scene, chooseEnvironment(scene, {}).environment);
  }
  return program::compile(program, compiler, defines).diagnostics;
}

}  // namespace

int checkCommand(Arguments arguments) {
  const std::optional<Options> options = parseOptions(arguments);
  if (!options) return 0;
  const shader::Compiler compiler = makeCompiler();
  std::vector<Diagnostic> all;
  for (const std::string& name : options->programs) {
    std::vector<Diagnostic> found;
    try {
      const program::Program program = program::loadProgram(name);
      found = check(program, compiler, *options);
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
  const bool warned = std::ranges::any_of(all, [](const Diagnostic& d) { return d.severity == shader::Severity::warning; });
  return hasErrors(all) || (options->strict && warned) ? 1 : 0;
}

}  // namespace quintet::app
