// SPDX-License-Identifier: Apache-2.0
// Rays per second, and the rate of minimal shaders for the same rays: the rays of a program's first sample are recorded
// and traced again, in the same order, by minimal shaders. Both rates come from one run, so their ratio holds on noisy
// machines. For programs with other rays, the time of a launch and what the driver reports about the pipeline.
#ifndef QUINTET_JOB_BENCHMARK_H
#define QUINTET_JOB_BENCHMARK_H

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "base/math.h"
#include "job/request.h"

namespace quintet::job {

struct BenchmarkRequest {
  std::filesystem::path scene;         // without `profile`, triangles without alpha: the replay supports nothing else
  scene::LoadOptions load;             // how `scene` is read
  std::string program = "pathtracer";  // its rays go through traceClosest and traceVisible
  std::string device;                  // gpu::ContextOptions::device
  std::string environment;             // EnvironmentRequest::source
  uvec2 size{0};                       // pixels; 0: 512x512 on a CPU, else 1920x1080. Height 0: as the width
  int repeat = 5;                      // measurements, of which the median counts; at least 1
  bool profile = false;  // where the time goes, instead of the gains by primitive order and launch balance
};

// One object: device, scene, "pathTracer" (rates and ratio), "accelerationStructures", and "profile" or "primitiveOrder"
// and "launchBalance". Keys end in their unit. Throws FileError, UsageError, ProgramError, gpu errors.
nlohmann::ordered_json runBenchmark(const BenchmarkRequest& request);

struct ProgramBenchmarkRequest {
  std::string program;   // any program, with any rays
  std::string device;    // gpu::ContextOptions::device
  int repeat = 5;        // measured launches; at least 1
  RenderRequest render;  // scene, load, camera, environment, size (0: as above), seed, parameters; the rest is unused
};

// One object about one launch of the whole image with a sample per pixel, or a frame: device, scene, "launch" (seconds
// on the device), "rays" by ray type (counted in a separate, instrumented launch), and "pipeline" (what the driver
// reports). Keys end in their unit. Throws FileError, UsageError, ProgramError, gpu errors.
nlohmann::ordered_json runProgramBenchmark(const ProgramBenchmarkRequest& request);

}  // namespace quintet::job
#endif
