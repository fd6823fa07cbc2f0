// SPDX-License-Identifier: Apache-2.0
// `quintet bench`: rays per second of a scene, and the time of the launches of any program (job/benchmark.h).
#include "job/benchmark.h"

#include <vector>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "cli/console.h"
#include "cli/parser.h"
#include "cli/values.h"
#include "job/scene_source.h"

namespace quintet::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kExamples =
    "  quintet bench scene.glb                        a table\n"
    "  quintet bench scene.glb --json --repeat 9      the same as JSON, medians of nine measurements\n"
    "  quintet bench scene.glb --profile              time by pass, rays by kind, launches, registers\n"
    "  quintet bench my_program/ scene.glb            time of a launch and rays of your own program\n"
    "  quintet bench my_program/ --set width=30       on its own scene, with a parameter\n";

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

}  // namespace

int benchCommand(Arguments arguments) {
  CLI::App app(
      "Measures the rays per second of a scene with the path tracer, and the rate of minimal shaders for the same "
      "rays;\n"
      "or the launches of any program.",
      "quintet bench");
  job::BenchmarkRequest request;
  job::ProgramBenchmarkRequest own;
  std::vector<std::string> positional;
  std::string size;
  bool json = false;
  app.add_option("SCENE | PROGRAM [SCENE]", positional,
                 "Scene of triangles without alpha (minimal shaders support nothing else); or a program, and its\n"
                 "scene: .gltf, .glb or .scene.toml (default: the program's own, or built in)")
      ->type_name("")
      ->required()
      ->expected(1, 2);
  app.add_option("--device", request.device, "Index or part of the name")->type_name("NAME");
  app.add_option("--env", request.environment, "Environment, as in 'quintet render'")->type_name("WHAT");
  app.add_option("--size", size, "Size in pixels (default: 512x512 on a CPU, else 1920x1080)")->type_name("WxH");
  app.add_option("--repeat", request.repeat, "Number of measurements; the result is their median (default: 5)")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  app.add_option("--program", request.program,
                 "Without PROGRAM: program to measure; its rays go through traceClosest and traceVisible "
                 "(default: pathtracer)")
      ->type_name("NAME");
  app.add_flag(
      "--profile", request.profile,
      "Without PROGRAM: show where the time goes, instead of the gains by primitive order and launch\nbalance");
  app.add_option("--set", own.render.assignments, "With PROGRAM: parameter of the program; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("NAME=VALUE");
  app.add_option("--set-file", own.render.parameterFile, "With PROGRAM: parameters as a JSON object")
      ->type_name("FILE.json");
  app.add_flag("--json", json, "Print one JSON object instead of a table");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return 0;
  if (!size.empty()) request.size = parseSize("--size", size);
  const bool ofScene = positional.size() == 1 && job::isSceneFile(positional[0]);
  for (const char* name : {"--program", "--profile"})
    if (!ofScene && app.count(name) > 0)
      throw UsageError(fmt::format("{} requires the form 'quintet bench SCENE'", name));
  for (const char* name : {"--set", "--set-file"})
    if (ofScene && app.count(name) > 0)
      throw UsageError(fmt::format("{} requires the form 'quintet bench PROGRAM [SCENE]'", name));
  request.scene = own.program = positional[0];
  if (positional.size() > 1) own.render.scene = positional[1];
  own.device = request.device;
  own.repeat = request.repeat;
  own.render.size = request.size;
  own.render.environment.source = request.environment;
  try {
    const Json result = ofScene ? job::runBenchmark(request) : job::runProgramBenchmark(own);
    writeFile("-", json ? result.dump() + "\n" : asTable(result));
  } catch (const ProgramError& error) {
    printDiagnostics(error.diagnostics(), nullptr, false);
    return 1;
  }
  return 0;
}

}  // namespace quintet::cli
