#include "instrument.h"

#include "gpu/context.h"
#include "hang.h"
#include "render/renderer.h"
#include "scene_setup.h"

namespace quintet::app {
namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 64;
constexpr std::uint32_t kFrames = 2;
constexpr double kTimeout = 20.0;

}  // namespace

std::vector<shader::Diagnostic> runInstrumented(const program::Program& program, const scene::Scene& scene,
                                                const shader::Compiler& compiler, const std::string& device) {
  gpu::ContextOptions options;
  options.device = device;
  gpu::Context context(options);
  render::DeviceScene deviceScene(context, scene, chooseEnvironment(scene, {}).environment);
  render::RenderSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.camera = chooseCamera(scene, {}, static_cast<float>(kWidth) / kHeight).camera;
  settings.instrument = true;
  settings.timeoutSeconds = kTimeout;
  render::Renderer renderer(deviceScene, program, compiler, nullptr, settings);
  withoutHanging(program, false, [&] {
    if (program.accumulation == program::Accumulation::program) {
      for (std::uint32_t frame = 0; frame < kFrames; ++frame) renderer.renderBatch(1);
    } else {
      renderer.renderBatch();
    }
  });
  return renderer.notes();
}

}  // namespace quintet::app
