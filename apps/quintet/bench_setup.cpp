#include <algorithm>

#include "base/file.h"
#include "bench.h"
#include "program/program.h"
#include "scene/load.h"
#include "scene_setup.h"
#include "values.h"

namespace quintet::app {
namespace {

shader::CompilerOptions compilerOptions() {
  shader::CompilerOptions compiler;
  if (!cacheFolder().empty()) compiler.cacheFolder = cacheFolder() / "shaders";
  return compiler;
}

}  // namespace

Bench::Bench(const BenchOptions& o, bool software)
    : options(o), scene(scene::loadScene(o.scene)), compiler(compilerOptions()) {
  size = o.size.empty() ? (software ? uvec2(512, 512) : uvec2(1920, 1080)) : parseSize("--size", o.size);
  if (size.y == 0) size.y = size.x;
  camera = chooseCamera(scene, {}, static_cast<float>(size.x) / static_cast<float>(size.y)).camera;
  EnvironmentOptions environmentOptions;
  environmentOptions.source = o.environment;
  environment = chooseEnvironment(scene, environmentOptions).environment;
}

render::RenderSettings Bench::settings(const program::Program& program, uvec2 pixels) const {
  render::RenderSettings settings;
  settings.width = pixels.x;
  settings.height = pixels.y;
  settings.camera = camera;
  settings.parameters = program::ParameterValues(program.parameters);
  settings.launchSeconds = 1.0;
  settings.timeoutSeconds = 300;
  return settings;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double sampleSeconds(render::Renderer& renderer) {
  const double before = renderer.statistics().deviceSeconds;
  renderer.renderBatch(1);
  renderer.finish();
  return renderer.statistics().deviceSeconds - before;
}

}  // namespace quintet::app
