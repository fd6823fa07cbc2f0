// SPDX-License-Identifier: Apache-2.0
// `quintet bench`: rays per second, and the rate of minimal shaders for the same rays (job/benchmark.h).
#include "job/benchmark.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "cli/candidates.h"
#include "cli/parser.h"
#include "cli/values.h"

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

struct Options {
  job::BenchmarkRequest request;
  std::string size;
  bool json = false;
};

OptionTable declare(Options& options) {
  OptionTable table("bench", "Measures rays per second, and the rate of minimal shaders for the same rays.");
  job::BenchmarkRequest& request = options.request;
  table.add({{.names = "SCENE",
              .help = "Scene of triangles without alpha (minimal shaders support nothing else)",
              .target = &request.scene,
              .candidates = {.extensions = kSceneExtensions},
              .required = true},
             {.names = "--device", .value = "NAME", .help = "Index or part of the name", .target = &request.device},
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
              .help = "Program to measure; its rays go through traceClosest and traceVisible (default: pathtracer)",
              .target = &request.program,
              .candidates = programCandidates()},
             {.names = "--profile",
              .help = "Show where the time goes, instead of the gains by primitive order and launch balance",
              .target = &request.profile},
             {.names = "--json", .help = "Print one JSON object instead of a table", .target = &options.json}});
  table.addExamples({
      {"quintet bench scene.glb", "a table"},
      {"quintet bench scene.glb --json --repeat 9", "the same as JSON, medians of nine measurements"},
      {"quintet bench scene.glb --profile", "time by pass, rays by kind, launches, registers"},
  });
  return table;
}

}  // namespace

OptionTable benchOptions() {
  Options options;
  return declare(options).withoutTargets();
}

int benchCommand(Arguments arguments) {
  Options options;
  if (!parse(declare(options), arguments)) return 0;
  job::BenchmarkRequest& request = options.request;
  if (request.scene.empty()) throw UsageError("no scene given; see 'quintet bench --help'");
  if (!options.size.empty()) request.size = parseSize("--size", options.size);
  const Json result = job::runBenchmark(request);
  writeFile("-", options.json ? result.dump() + "\n" : asTable(result));
  return 0;
}

}  // namespace quintet::cli
