// SPDX-License-Identifier: Apache-2.0
// `quintet bench`: rays per second, and the rate of minimal shaders for the same rays (job/benchmark.h).
#include "job/benchmark.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/file.h"
#include "cli/parser.h"
#include "cli/values.h"

namespace quintet::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kExamples =
    "  quintet bench scene.glb                        a table\n"
    "  quintet bench scene.glb --json --repeat 9      the same as JSON, medians of nine measurements\n"
    "  quintet bench scene.glb --profile              time by pass, rays by kind, launches, registers\n";

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
  CLI::App app("Measures rays per second, and the rate of minimal shaders for the same rays.", "quintet bench");
  job::BenchmarkRequest request;
  std::string size;
  bool json = false;
  app.add_option("SCENE", request.scene, "Scene of triangles without alpha (minimal shaders support nothing else)")
      ->type_name("")
      ->required();
  app.add_option("--device", request.device, "Index or part of the name")->type_name("NAME");
  app.add_option("--env", request.environment, "Environment, as in 'quintet render'")->type_name("WHAT");
  app.add_option("--size", size, "Size in pixels (default: 512x512 on a CPU, else 1920x1080)")->type_name("WxH");
  app.add_option("--repeat", request.repeat, "Number of measurements; the result is their median (default: 5)")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  app.add_option("--program", request.program,
                 "Program to measure; its rays go through traceClosest and traceVisible "
                 "(default: pathtracer)")
      ->type_name("NAME");
  app.add_flag("--profile", request.profile,
               "Show where the time goes, instead of the gains by primitive order and launch balance");
  app.add_flag("--json", json, "Print one JSON object instead of a table");
  setUp(app, kExamples);
  if (!parse(app, arguments)) return 0;
  if (!size.empty()) request.size = parseSize("--size", size);
  const Json result = job::runBenchmark(request);
  writeFile("-", json ? result.dump() + "\n" : asTable(result));
  return 0;
}

}  // namespace quintet::cli
