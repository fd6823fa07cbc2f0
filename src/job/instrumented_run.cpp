// SPDX-License-Identifier: Apache-2.0
#include "job/instrumented_run.h"

#include <utility>

#include "gpu/error.h"
#include "job/device_limits.h"
#include "job/runnable_program.h"
#include "job/view.h"
#include "render/renderer/renderer.h"

namespace quintet::job {

std::vector<Diagnostic> runInstrumented(Engine& engine, const program::Program& program, scene::Scene scene,
                                        Observer& observer) {
  constexpr std::uint32_t kWidth = 96, kHeight = 64;
  constexpr std::uint32_t kFrames = 2;
  constexpr double kTimeout = 20.0;
  render::RenderSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.camera = chooseCamera(scene, {}, static_cast<float>(kWidth) / kHeight).camera;
  settings.instrument = true;
  settings.timeoutSeconds = kTimeout;
  const scene::Environment environment = chooseEnvironment(scene, {}).environment;
  gpu::Context& context = engine.context();
  render::DeviceScene deviceScene(context, std::move(scene), environment);
  CheckedProgram checked = compileAndCheck(program, engine.compiler(), render::renderDefines(deviceScene.defines(), {}),
                                           deviceScene.facts(), deviceLimits(context.info()), true);
  render::Renderer renderer(deviceScene, std::move(checked.runnable), engine.compiler(), nullptr, settings);
  try {
    if (program.accumulation == program::Accumulation::program) {
      for (std::uint32_t frame = 0; frame < kFrames; ++frame) renderer.renderFrame(frame);
    } else {
      renderer.renderBatch();
    }
    return renderer.runtimeDiagnostics();
  } catch (const gpu::TimeoutError& error) {
    observer.deviceHung(hangDiagnostic(program, error.seconds()));
    throw;
  }
}

}  // namespace quintet::job
