// SPDX-License-Identifier: Apache-2.0
// `quintet bench`: rays per second, and the rate of minimal shaders for the same rays (job/benchmark.h).
#include "job/benchmark.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/text.h"
#include "cli/candidates.h"
#include "cli/console.h"
#include "cli/failure.h"
#include "cli/parser.h"
#include "cli/render_options.h"
#include "cli/values.h"
#include "cli/work.h"
#include "job/scene_source.h"

namespace quintet::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string asTable(const Json& json, const std::string& prefix = {}) {
  std::string text;
  for (const auto& [key, value] : json.items()) {
    const std::string name = prefix.empty() ? key : prefix + "." + key;
    if (value.is_object())
      text += asTable(value, name);
    else
      text += fmt::format("{:<48} {}\n", name,
                          value.is_number_float() ? fmt::format("{:.4g}", value.get<double>())
                          : value.is_string()     ? value.get<std::string>()
                                                  : value.dump());
  }
  return text;
}

struct BenchOptions {
  job::BenchmarkRequest request;
  job::ProgramBenchmarkRequest own;
  std::vector<std::string> positional;
  std::string program;  // --program
  std::string size;
  LoadTexts load;
  bool json = false;
};

OptionTable declareBench(BenchOptions& options) {
  OptionTable table("bench",
                    "Measures the rays per second of a scene with the path tracer, and the rate of minimal shaders for "
                    "the same rays; or the launches of any program.");
  job::BenchmarkRequest& request = options.request;
  table.add({{.names = "SCENE|PROGRAM",
              .help = "Scene, of triangles without alpha unless --profile is given (minimal shaders support nothing "
                      "else); or a program, and its scene: .gltf, .glb or .scene.toml (default: the program's own, or "
                      "built in)",
              .target = &options.positional,
              .candidates = programOrSceneCandidates(),
              .required = true},
             {.names = "--device",
              .value = "NAME",
              .help = std::string(kDeviceHelp),
              .target = &request.device,
              .candidates = {.names = deviceNames()}},
             {.names = "--env",
              .value = "WHAT",
              .help = "Environment, as in 'quintet render'",
              .target = &request.environment},
             {.names = "--size",
              .value = "WxH",
              .help = "Size in pixels (default: 512x512 on a CPU, else 1920x1080)",
              .target = &options.size},
             {.names = "--repeat",
              .value = "N",
              .help = "Number of measurements; the result is their median (default: 5)",
              .target = &request.repeat,
              .min = 1,
              .max = 1000},
             {.names = "--program",
              .value = "NAME",
              .help = "Without PROGRAM: program to measure; its rays go through traceClosest and traceVisible "
                      "(default: pathtracer)",
              .target = &options.program,
              .candidates = programCandidates()},
             {.names = "--profile",
              .help = "Without PROGRAM: show where the time goes, instead of the gains by primitive order and launch "
                      "balance",
              .target = &request.profile},
             {.names = "--set",
              .value = "NAME=VALUE",
              .help = "With PROGRAM: parameter of the program; may be repeated",
              .target = &options.own.render.assignments},
             {.names = "--set-file",
              .value = "FILE.json",
              .help = "With PROGRAM: parameters as a JSON object",
              .target = &options.own.render.parameterFile,
              .candidates = {.extensions = {"json"}}},
             {.names = "--json", .help = "Print one JSON object instead of a table", .target = &options.json}});
  declareLoading(table, options.load, request.load);
  table.addExamples({
      {"quintet bench scene.glb", "a table"},
      {"quintet bench scene.glb --json --repeat 9", "the same as JSON, medians of nine measurements"},
      {"quintet bench scene.glb --profile", "time by pass, rays by kind, launches, registers"},
      {"quintet bench my_program/ scene.glb", "time of a launch and rays of your own program"},
      {"quintet bench my_program/ --set width=30", "on its own scene, with a parameter"},
  });
  return table;
}

// Options of the other form are errors.
void rejectOptions(const BenchOptions& options, bool ofScene) {
  const auto reject = [&](bool given, const char* name, const char* form) {
    if (given) throw UsageError(fmt::format("{} requires the form 'quintet bench {}'", name, form));
  };
  if (ofScene) {
    reject(!options.own.render.assignments.empty(), "--set", "PROGRAM [SCENE]");
    reject(!options.own.render.parameterFile.empty(), "--set-file", "PROGRAM [SCENE]");
  } else {
    reject(!options.program.empty(), "--program", "SCENE");
    reject(options.request.profile, "--profile", "SCENE");
  }
}

}  // namespace

OptionTable benchOptions() {
  BenchOptions options;
  return declareBench(options).withoutTargets();
}

int benchCommand(Arguments arguments) {
  BenchOptions options;
  if (!parse(declareBench(options), arguments)) return 0;
  const std::vector<std::string>& positional = options.positional;
  if (positional.empty()) throw UsageError("no scene or program given; see 'quintet bench --help'");
  if (positional.size() > 2)
    throw UsageError(fmt::format("unexpected argument '{}'; see 'quintet bench --help'", printable(positional[2])));
  const bool ofScene = positional.size() == 1 && job::isSceneFile(positional[0]);
  rejectOptions(options, ofScene);
  job::BenchmarkRequest& request = options.request;
  job::ProgramBenchmarkRequest& own = options.own;
  if (!options.size.empty()) request.size = parseSize("--size", options.size);
  if (!options.program.empty()) request.program = options.program;
  request.scene = own.program = positional[0];
  if (positional.size() > 1) own.render.scene = positional[1];
  convertLoading(options.load, request.load);
  own.render.load = request.load;
  own.device = request.device;
  own.repeat = request.repeat;
  own.render.size = request.size;
  own.render.environment.source = request.environment;
  setWorkProgram(ofScene ? request.program : own.program);
  setWorkStage("measuring");
  try {
    const Json result = ofScene ? job::runBenchmark(request) : job::runProgramBenchmark(own);
    writeFile("-", options.json ? result.dump() + "\n" : asTable(result));
  } catch (const ProgramError& error) {
    printDiagnostics(error.diagnostics(), nullptr, options.json);
    return kRuntimeError;
  }
  return 0;
}

}  // namespace quintet::cli
