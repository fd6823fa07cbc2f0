// `quintet bench --profile`: where the time of a rendering goes.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "bench.h"
#include "program/payload_sizes.h"
#include "render/tone_map.h"
#include "rt/pipeline_statistics.h"

namespace quintet::app {
namespace {

using Json = Bench::Json;
using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// What a driver says, or that it says nothing.
Json pipelineFacts(const rt::Pipeline& pipeline) {
  Json executables = Json::object();
  for (const rt::PipelineExecutable& e : rt::pipelineStatistics(pipeline)) {
    Json object = {{"subgroupSize", e.subgroupSize}};
    for (const auto& [name, value] : e.statistics) object[name] = value;
    std::string key = e.name;
    for (int i = 2; executables.contains(key); ++i) key = fmt::format("{} {}", e.name, i);
    executables[key] = std::move(object);
  }
  Json stack = Json::object();
  for (const auto& [name, bytes] : rt::groupStackSizes(pipeline)) stack[name] = bytes;
  return {{"executables", executables.empty() ? Json("not told by the driver") : std::move(executables)},
          {"stackBytes", std::move(stack)}};
}

// What travels with a ray, by the payload's type: the largest of all stages.
Json payloadFacts(const program::CompiledProgram& compiled) {
  std::map<std::string, std::uint64_t> bytes;
  for (const program::PayloadSize& payload : program::payloadSizes(compiled))
    bytes[payload.type] = std::max(bytes[payload.type], payload.bytes);
  return bytes;
}

// Sums over launches; the gaps are those between launches, not that before the first one.
Json launchFacts(std::span<const render::LaunchTiming> launches, std::uint32_t width) {
  std::vector<double> invocations, seconds, idle;
  for (const render::LaunchTiming& launch : launches) {
    invocations.push_back(static_cast<double>(launch.rows) * width);
    seconds.push_back(launch.traceSeconds);
    idle.push_back(launch.idleSeconds);
  }
  return {{"count", launches.size()},
          {"medianInvocations", median(invocations)},
          {"medianSamplesPerPixel", launches[launches.size() / 2].samples},
          {"medianSeconds", median(seconds)},
          {"largestSeconds", *std::ranges::max_element(seconds)},
          {"medianIdleSeconds", median(idle)}};
}

}  // namespace

Json profile(const Bench& bench, render::DeviceScene& scene) {
  const program::Program program = program::loadProgram(bench.options.program);
  render::RenderSettings settings = bench.settings(program, bench.size);
  const render::RenderSettings defaults;
  settings.launchSeconds = defaults.launchSeconds;
  settings.profile = true;
  render::Renderer renderer(scene, program, bench.compiler, nullptr, settings);
  renderer.renderBatch();  // the driver compiles, and the launches find their size
  renderer.finish();
  const std::size_t warm = renderer.launches().size();
  const std::uint64_t raysBefore = renderer.rays().rays;
  const double wallBefore = renderer.statistics().renderSeconds;
  for (int i = 0; i < bench.options.repeat; ++i) renderer.renderBatch();
  renderer.finish();
  const double samples =
      static_cast<double>(bench.size.x) * bench.size.y * render::kBatchSamples * bench.options.repeat;
  const double wall = renderer.statistics().renderSeconds - wallBefore;
  const std::span<const render::LaunchTiming> launches = std::span(renderer.launches()).subspan(warm);
  double begin = 0, trace = 0, end = 0, idle = 0;
  for (const render::LaunchTiming& l : launches) begin += l.beginSeconds, trace += l.traceSeconds, end += l.endSeconds;
  for (const render::LaunchTiming& l : launches.subspan(1)) idle += l.idleSeconds;
  const double busy = begin + trace + end;

  const auto downloading = Clock::now();
  const io::Image image = renderer.image();
  const double download = secondsSince(downloading);
  const auto mapping = Clock::now();
  render::toDisplay(image, render::ToneMap::aces, 0.0f, true);
  const double mapped = secondsSince(mapping);

  Json pipeline = pipelineFacts(renderer.linked().pipeline());
  pipeline["payloadBytes"] = payloadFacts(program::compile(program, bench.compiler, scene.defines()));
  const render::DeviceSceneStatistics& s = scene.statistics();
  return {{"samplesPerBatch", render::kBatchSamples},
          {"batches", bench.options.repeat},
          {"passes",
           {{"uploadSeconds", s.uploadSeconds},
            {"orderSeconds", s.build.orderSeconds},
            {"bottomLevelBuildSeconds", s.build.buildSeconds},
            {"topLevelBuildSeconds", s.topLevelSeconds},
            {"beginBatchSeconds", begin},
            {"traceSeconds", trace},
            {"filmAddSeconds", end},
            {"downloadSeconds", download},
            {"toneMapSeconds", mapped}}},
          {"deviceBusySeconds", busy},
          {"deviceIdleSeconds", idle},
          {"wallSeconds", wall},
          {"busyShare", busy / wall},
          {"samplesPerSecond", samples / wall},
          {"MraysPerSecond", static_cast<double>(renderer.rays().rays - raysBefore) / trace * 1e-6},
          {"launches", launchFacts(launches, bench.size.x)},
          {"pipeline", std::move(pipeline)}};
}

}  // namespace quintet::app
