// SPDX-License-Identifier: Apache-2.0
#include "job/instrumented_run.h"

#include <algorithm>
#include <utility>

#include "gpu/error.h"
#include "job/device_limits.h"
#include "job/resolve.h"
#include "job/runnable_program.h"
#include "job/view.h"
#include "render/renderer/renderer.h"

namespace quintet::job {
namespace {

constexpr uvec2 kSize{96, 64};
constexpr std::uint64_t kFrames = 2;

render::RenderSettings settingsFor(const program::Program& program, const scene::Scene& scene,
                                   const RenderRequest& request) {
  const uvec2 size = request.size.x > 0 ? request.size : kSize;
  const float aspect = size.y > 0 ? static_cast<float>(size.x) / static_cast<float>(size.y) : 0.0f;
  render::RenderSettings settings;
  settings.camera = chooseCamera(scene, request.camera, aspect).camera;
  const uvec2 chosen = chooseImageSize(size, settings.camera);
  settings.width = chosen.x;
  settings.height = chosen.y;
  settings.region = request.region;
  settings.seed = request.seed;
  settings.parameters = parameterValues(program, request);
  settings.maxMemory = request.load.maxMemory;
  settings.outputs = request.outputs;
  settings.instrument = true;
  settings.timeoutSeconds = request.launchTimeout;
  return settings;
}

void renderSamples(render::Renderer& renderer, std::uint64_t count) {
  constexpr std::uint64_t kBatch = render::kBatchSamples;
  for (std::uint64_t done = 0; done < count; done += kBatch)
    renderer.renderBatch(static_cast<std::uint32_t>(std::min(kBatch, count - done)));
}

}  // namespace

std::vector<Diagnostic> runInstrumented(Engine& engine, const program::Program& program, scene::Scene scene,
                                        const RenderRequest& request,
                                        const std::function<void(const Diagnostic&)>& hung) {
  const render::RenderSettings settings = settingsFor(program, scene, request);
  const scene::Environment environment =
      chooseEnvironment(scene, request.environment, request.load.maxMemory).environment;
  gpu::Context& context = engine.context();
  render::DeviceScene deviceScene(context, std::move(scene), environment);
  CheckedProgram checked =
      compileAndCheck(program, engine.compiler(), render::renderDefines(deviceScene.defines(), request.outputs),
                      deviceScene.facts(), deviceLimits(context.info()), program::Instrumentation::checks);
  render::Renderer renderer(deviceScene, std::move(checked.runnable), engine.compiler(), nullptr, settings);
  try {
    const bool accumulates = program.accumulation == program::Accumulation::program;
    renderSamples(renderer, request.limits.samples.value_or(accumulates ? kFrames : render::kBatchSamples));
    return renderer.runtimeDiagnostics();
  } catch (const TimeoutError& error) {
    hung(hangDiagnostic(program, error));
    throw;
  }
}

}  // namespace quintet::job
