// SPDX-License-Identifier: Apache-2.0
// quintet_recursion_cost [PROGRAM…]: the cost of counting the recursion of programs whose traces form a cycle.
//
// Each program is compiled twice from the same sources, with the counter (as runs do) and without it. Both renderers run
// alternately in one process, in the order A B B A, so that the ratio does not depend on the clock of the device. The time
// is that of the traces, by time stamps of the device. Both must give the same image, up to rounding.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "base/error.h"
#include "gpu/driver_environment.h"
#include "job/device_limits.h"
#include "job/engine.h"
#include "job/runnable_program.h"
#include "job/scene_source.h"
#include "job/view.h"
#include "program/load.h"
#include "render/renderer/renderer.h"

namespace quintet::bench {
namespace {

constexpr double kLaunchSeconds = 1.0;  // a frame is one launch
constexpr double kTimeout = 300;        // seconds
constexpr double kSameImage = 1e-4;     // relative difference of images of one sample

struct Options {
  std::vector<std::string> programs{"lessons/07_mirror_recursion"};
  std::string scene, device;
  std::uint32_t width = 3840, height = 2160, rounds = 15;
  double seconds = 0.5;
};

// Device time of the traces of `count` frames, or samples per pixel.
double traceSeconds(render::Renderer& renderer, std::uint32_t count) {
  const std::size_t before = renderer.launches().size();
  for (std::uint32_t i = 0; i < count; ++i) renderer.renderBatch(1);
  renderer.finish();
  double seconds = 0;
  for (std::size_t i = before; i < renderer.launches().size(); ++i) seconds += renderer.launches()[i].traceSeconds;
  return seconds;
}

// Mean of |a - b| over the mean of |a|. The compiler of a driver may round differently in the two variants.
double difference(const io::Image& a, const io::Image& b) {
  const std::span<const float> left = a.samples<float>(), right = b.samples<float>();
  double sum = 0, scale = 0;
  for (std::size_t i = 0; i < std::min(left.size(), right.size()); ++i)
    sum += std::abs(left[i] - right[i]), scale += std::abs(left[i]);
  return scale > 0 ? sum / scale : sum;
}

double quantile(std::vector<double> values, double fraction) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1) + 0.5)];
}

// Returns the row of the table.
std::string measure(job::Engine& engine, const std::string& name, const Options& options) {
  const program::Program program = program::loadProgram(name);
  scene::Scene scene = job::loadScene(job::chooseSceneSource(options.scene, program));
  render::RenderSettings settings;
  settings.width = options.width;
  settings.height = options.height;
  settings.camera =
      job::chooseCamera(scene, {}, static_cast<float>(options.width) / static_cast<float>(options.height)).camera;
  settings.parameters = program::ParameterValues(program.parameters);
  settings.launchSeconds = kLaunchSeconds;
  settings.timeoutSeconds = kTimeout;
  settings.profile = true;
  const scene::Environment environment = job::chooseEnvironment(scene, {}).environment;
  render::DeviceScene deviceScene(engine.context(), std::move(scene), environment);

  const render::Defines defines = render::renderDefines(deviceScene.defines(), {});
  const job::CheckedProgram plain = job::checkCompiled(program, program::compile(program, engine.compiler(), defines),
                                                       deviceScene.facts(), job::deviceLimits(engine.context().info()));
  if (!plain.cyclic) throw UsageError(fmt::format("{}: the traces form no cycle, so they are not counted", name));
  job::CheckedProgram counting = plain;
  job::countRecursion(counting, engine.compiler(), defines);
  render::Renderer without(deviceScene, plain.runnable, engine.compiler(), nullptr, settings);
  render::Renderer with(deviceScene, counting.runnable, engine.compiler(), nullptr, settings);

  std::uint32_t frames = 1;
  for (render::Renderer* renderer : {&without, &with}) traceSeconds(*renderer, 1);  // the first one is slower
  while (traceSeconds(without, frames) < options.seconds && frames < (1u << 20)) frames *= 2;
  std::vector<double> ratios, base;
  for (std::uint32_t round = 0; round < options.rounds; ++round) {
    const double first = traceSeconds(without, frames);
    const double counted = traceSeconds(with, frames) + traceSeconds(with, frames);
    base.push_back((first + traceSeconds(without, frames)) / (2.0 * frames));
    ratios.push_back(counted / (2.0 * frames) / base.back());
  }
  for (render::Renderer* renderer : {&without, &with}) {
    renderer->restart();
    renderer->renderBatch(1);
  }
  if (const double changed = difference(without.image(), with.image()); !(changed < kSameImage))
    throw Error(fmt::format("{}: the counter changes the image by {:.2g} of its mean", name, changed));
  return fmt::format("| {} | {} | {:.3f} | **{:.4f}** | {:.4f} to {:.4f} | {} |\n", name, frames,
                     1e3 * quantile(base, 0.5), quantile(ratios, 0.5), quantile(ratios, 0.25), quantile(ratios, 0.75),
                     with.skippedTraces());
}

void declare(CLI::App& app, Options& options) {
  app.add_option("PROGRAM", options.programs, "Programs whose traces form a cycle")->capture_default_str();
  app.add_option("--scene", options.scene, "Scene (default: each program's own)");
  app.add_option("--width", options.width, "Width of the image in pixels")->capture_default_str();
  app.add_option("--height", options.height, "Height of the image in pixels")->capture_default_str();
  app.add_option("--rounds", options.rounds, "Number of ratios; the table has their median and quartiles")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "Seconds on the device per measurement")->capture_default_str();
  app.add_option("--device", options.device, "Device: index or part of the name");
}

int run(const Options& options) {
  job::Engine engine({.device = options.device});
  const gpu::DeviceInfo& device = engine.context().info();
  fmt::print("{}, {}, {}x{}\n\n", device.name, device.driver, options.width, options.height);
  fmt::print(
      "| program | frames | ms per frame without the counter | ratio with / without | quartiles | skipped traces |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  for (const std::string& name : options.programs) {
    fmt::print("{}", measure(engine, name, options));
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace quintet::bench

int main(int argc, char** argv) {
  CLI::App app("Measure the cost of counting the recursion. Prints a table; 1.02 means 2 % more time.");
  quintet::bench::Options options;
  quintet::bench::declare(app, options);
  CLI11_PARSE(app, argc, argv);
  quintet::gpu::prepareDriverEnvironment();  // before other threads exist
  try {
    return quintet::bench::run(options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "quintet_recursion_cost: {}\n", error.what());
    return 1;
  }
}
