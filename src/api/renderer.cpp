#include <algorithm>

#include <fmt/format.h>

#include "api/impl.h"
#include "scene/auto_camera.h"
#include "scene/default_environment.h"

namespace quintet {
namespace {

vec3 toVec3(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

scene::Camera makeCamera(const scene::Scene& scene, const Settings& settings) {
  if (!settings.camera) {
    if (!scene.cameras.empty()) return scene.cameras.front();
    return scene::frameScene(scene::worldBounds(scene),
                             static_cast<float>(settings.width) / static_cast<float>(std::max(1u, settings.height)));
  }
  const Camera& camera = *settings.camera;
  return scene::lookAtCamera(toVec3(camera.lookFrom), toVec3(camera.lookAt), toVec3(camera.up), camera.verticalFov,
                             camera.apertureRadius);
}

program::ParameterValues makeParameters(const program::Program& program, const Settings& settings) {
  program::ParameterValues values(program.parameters);
  for (const auto& [name, value] : settings.parameters) values.set(name, value);
  return values;
}

}  // namespace

Renderer::Renderer(Device& device, const Scene& scene, const Program& program, const Settings& settings)
    : impl_(std::make_unique<Impl>()) {
  const scene::Scene& data = scene.impl_->scene;
  const program::Program& description = program.impl_->program;
  render::RenderSettings render;
  render.width = settings.width;
  render.height = settings.height;
  render.seed = settings.seed;
  render.plannedSamples = 0;
  render.camera = makeCamera(data, settings);
  render.parameters = makeParameters(description, settings);
  impl_->framewise = description.accumulation == program::Accumulation::program;
  impl_->scene = std::make_unique<render::DeviceScene>(*device.impl_->context, data, scene::environmentInUse(data));
  try {
    impl_->renderer = std::make_unique<render::Renderer>(*impl_->scene, description, *device.impl_->compiler,
                                                         device.impl_->pipelines.get(), render);
  } catch (const render::ProgramError& error) {
    std::vector<Diagnostic> diagnostics;
    std::ranges::transform(error.diagnostics(), std::back_inserter(diagnostics), api::toPublic);
    throw ProgramError(std::move(diagnostics));
  }
}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

void Renderer::render(std::uint32_t count) {
  while (count > 0) {
    const std::uint32_t part = std::min(count, impl_->framewise ? 1u : render::kBatchSamples);
    if (impl_->framewise) {
      impl_->scene->setFrame(static_cast<float>(sampleCount()));
      impl_->renderer->renderFrame(static_cast<std::uint32_t>(sampleCount()));
    } else {
      impl_->renderer->renderBatch(part);
    }
    count -= part;
  }
}

std::uint64_t Renderer::sampleCount() const { return impl_->renderer->statistics().samples; }

Picture Renderer::picture(const std::string& output) const {
  const program::Program& program = impl_->renderer->program();
  const std::vector<std::string> outputs = program::outputNames(program);
  const auto found = output.empty() ? outputs.begin() : std::ranges::find(outputs, output);
  if (found == outputs.end())
    throw UsageError(fmt::format("no output '{}'; there are {}", output, fmt::join(outputs, ", ")));
  const io::Image image = impl_->renderer->image(static_cast<std::size_t>(found - outputs.begin()));
  const std::span<const float> samples = image.samples<float>();
  const bool isColor =
      program.outputs[static_cast<std::size_t>(found - outputs.begin())].kind == program::OutputKind::color;
  return {image.width, image.height, {samples.begin(), samples.end()}, isColor};
}

}  // namespace quintet
