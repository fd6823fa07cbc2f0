// The rays of a program's first sample, counted by kind, and the program's rate against that of the same rays traced
// by minimal shaders.
#include "bench.h"
#include "program/program.h"

namespace quintet::app {
namespace {

Bench::Json kind(std::uint32_t rays, std::uint32_t hits) {
  return {{"rays", rays}, {"hits", hits}, {"misses", rays - hits}};
}

}  // namespace

// Path tracer against the replay of its own rays. Batches differ in their samples; the recorded one is the first, and
// the path tracer's time is of the same sample: each measurement takes a fresh renderer's first batch.
Bench::Json pathTracerRatio(const Bench& bench, render::DeviceScene& scene) {
  gpu::Context& context = scene.context();
  const program::Program pathTracer = program::loadProgram(bench.options.program);
  const program::Program replay = program::loadProgram("replay");
  constexpr std::uint32_t kCapacity = 32;
  gpu::BufferOptions recordOptions;
  recordOptions.size =
      sizeof(shared::RayKinds) + VkDeviceSize{bench.size.x} * bench.size.y * kCapacity * sizeof(shared::RayRecord);
  recordOptions.name = "ray records";
  const gpu::Buffer records(context, recordOptions);
  context.submitAndWait([&](gpu::Commands& commands) { commands.fill(records, 0); });

  render::RenderSettings recording = bench.settings(pathTracer, bench.size);
  recording.defines.emplace_back("QUINTET_RECORD_RAYS", "1");
  recording.rayRecords = &records;
  recording.rayRecordCapacity = kCapacity;
  render::Renderer recorder(scene, pathTracer, bench.compiler, nullptr, recording);
  recorder.renderBatch(1);
  const std::uint64_t rays = recorder.rays().rays;
  const shared::RayKinds kinds = records.downloadAs<shared::RayKinds>(1)[0];

  render::Renderer tracer(scene, pathTracer, bench.compiler, nullptr, bench.settings(pathTracer, bench.size));
  render::RenderSettings replaying = bench.settings(replay, bench.size);
  replaying.rayRecords = &records;
  replaying.rayRecordCapacity = kCapacity;
  render::Renderer replayer(scene, replay, bench.compiler, nullptr, replaying);

  sampleSeconds(tracer);
  sampleSeconds(replayer);
  const std::uint64_t replayedRays = replayer.rays().rays;
  // In turns, so that both see the same machine.
  std::vector<double> tracerRates, replayRates;
  for (int i = 0; i < bench.options.repeat; ++i) {
    const std::uint64_t before = tracer.rays().rays;
    const double seconds = sampleSeconds(tracer);
    tracerRates.push_back(static_cast<double>(tracer.rays().rays - before) / seconds);
    replayRates.push_back(static_cast<double>(replayedRays) / sampleSeconds(replayer));
  }
  const double tracerRate = median(tracerRates);
  const double replayRate = median(replayRates);
  return {{"raysPerSample", rays},
          {"rays",
           {{"camera", kind(kinds.camera, kinds.cameraHits)},
            {"continuation", kind(kinds.continuation, kinds.continuationHits)},
            {"shadow", kind(kinds.shadow, kinds.shadowHits)}}},
          {"replayedRays", replayedRays},
          {"pathTracerMraysPerSecond", tracerRate * 1e-6},
          {"minimalMraysPerSecond", replayRate * 1e-6},
          {"ratio", tracerRate / replayRate},
          {"compileSeconds", tracer.statistics().compileSeconds},
          {"pipelineSeconds", tracer.statistics().pipelineSeconds},
          {"firstLaunchSeconds", tracer.statistics().firstLaunchSeconds}};
}

}  // namespace quintet::app
