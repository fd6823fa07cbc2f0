// SPDX-License-Identifier: Apache-2.0
#include "job/depth_map.h"

#include <cstddef>
#include <utility>

#include "job/picking_program.h"
#include "render/renderer/renderer.h"

namespace quintet::job {

DepthMap renderDepthMap(Engine& engine, render::DeviceScene& scene, const scene::Camera& camera, uvec2 size,
                        const program::Program& shown) {
  program::RunnableProgram program = pickingProgram(engine, scene, shown, "depth.rgen");
  program.description.outputs.resize(1);  // depth.rgen writes only the first output
  render::RenderSettings settings;
  settings.width = size.x;
  settings.height = size.y;
  settings.camera = camera;
  settings.parameters = program::ParameterValues(program.description.parameters);
  render::Renderer renderer(scene, std::move(program), engine.compiler(), &engine.pipelineCache(), settings);
  renderer.renderBatch(1);
  renderer.finish();
  const io::Image image = renderer.displayImage();
  DepthMap result{size, camera, std::vector<float>(std::size_t{size.x} * size.y)};
  const auto samples = image.samples<float>();
  for (std::size_t i = 0; i < result.depths.size(); ++i) result.depths[i] = samples[i * image.channels];
  return result;
}

DepthMap renderDepthMap(Engine& engine, RenderJob& job) {
  job.showCurrentFrame();  // with a shutter, the scene is that of the last sample
  return renderDepthMap(engine, *job.scene()->onDevice, job.camera(), job.scene()->size, job.resolved().program);
}

}  // namespace quintet::job
