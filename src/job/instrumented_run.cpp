// SPDX-License-Identifier: Apache-2.0
#include "job/instrumented_run.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "gpu/error.h"
#include "job/device_limits.h"
#include "job/resolve.h"
#include "job/runnable_program.h"
#include "job/value_origin.h"
#include "job/view.h"
#include "program/load.h"
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

std::uint64_t sampleCount(const program::Program& program, const RenderRequest& request) {
  const bool accumulates = program.accumulation == program::Accumulation::program;
  return request.limits.samples.value_or(accumulates ? kFrames : render::kBatchSamples);
}

void renderSamples(render::Renderer& renderer, std::uint64_t count) {
  constexpr std::uint64_t kBatch = render::kBatchSamples;
  for (std::uint64_t done = 0; done < count; done += kBatch)
    renderer.renderBatch(static_cast<std::uint32_t>(std::min(kBatch, count - done)));
}

// Gives the diagnostics Q002 the location of the operation that made the value. They are about outputs, whose store is
// seldom the cause.
void locateNotFinite(Engine& engine, render::DeviceScene& scene, const program::Program& program,
                     const RenderRequest& request, const render::RenderSettings& settings,
                     const render::Renderer& renderer, std::vector<Diagnostic>& found) {
  const auto isNotFinite = [](const Diagnostic& d) { return d.id == "Q002"; };
  if (program::isBuiltIn(program) || std::ranges::none_of(found, isNotFinite)) return;
  const std::vector<render::NotFinitePixels> pixels = renderer.notFinitePixels();
  ValueOriginFinder finder(engine, scene, program, request.outputs, settings,
                           pixels.empty() ? renderer.rays().firstDropped : pixels.front().first);
  const std::optional<ValueOrigin> origin =
      finder.find([&](render::Renderer& variant) { renderSamples(variant, sampleCount(program, request)); });
  if (!origin) return;
  for (Diagnostic& diagnostic : found) {
    if (!isNotFinite(diagnostic)) continue;
    diagnostic.file = origin->location.file;
    diagnostic.line = origin->location.line;
    diagnostic.column = origin->location.column;
    diagnostic.text = fmt::format("{}; {}", originText(*origin), diagnostic.text);
  }
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
    renderSamples(renderer, sampleCount(program, request));
    std::vector<Diagnostic> found = renderer.runtimeDiagnostics();
    locateNotFinite(engine, deviceScene, program, request, settings, renderer, found);
    return found;
  } catch (const TimeoutError& error) {
    hung(hangDiagnostic(program, error));
    throw;
  }
}

}  // namespace quintet::job
