// What the measurements of `quintet bench` share: the scene, the settings, and how a time is taken.
#ifndef QUINTET_APP_BENCH_H
#define QUINTET_APP_BENCH_H

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "render/renderer.h"
#include "scene/scene.h"

namespace quintet::app {

struct BenchOptions {
  std::string scene;
  std::string program = "pathtracer";
  std::string device;
  std::string environment;
  std::string size;
  int repeat = 5;
  bool profile = false;
  bool json = false;
};

struct Bench {
  using Json = nlohmann::ordered_json;

  const BenchOptions& options;
  scene::Scene scene;
  scene::Environment environment;
  scene::Camera camera;
  uvec2 size;
  shader::Compiler compiler;

  // `software`: the device is a CPU, the default size is smaller.
  Bench(const BenchOptions& o, bool software);

  render::RenderSettings settings(const program::Program& program, uvec2 pixels) const;
};

double median(std::vector<double> values);

// Seconds of the device for one more sample per pixel.
double sampleSeconds(render::Renderer& renderer);

// Path tracer against the replay of its own rays, and the rays by kind.
Bench::Json pathTracerRatio(const Bench& bench, render::DeviceScene& scene);

// Where the time of a rendering goes: passes, launches, samples per second, and what the driver tells of the pipeline.
Bench::Json profile(const Bench& bench, render::DeviceScene& scene);

}  // namespace quintet::app
#endif
