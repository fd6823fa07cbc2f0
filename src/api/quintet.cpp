// SPDX-License-Identifier: Apache-2.0
// The classes of quintet.h, each a thin handle of the layers below.
#include <quintet/quintet.h>

#include <algorithm>

#include <fmt/format.h>

#include "check/check.h"
#include "check/scene_facts.h"
#include "gpu/instance.h"
#include "job/render_job.h"
#include "program/load.h"
#include "scene/load.h"

namespace quintet {

struct Device::Impl {
  explicit Impl(job::EngineOptions options) : engine(std::move(options)) {}
  job::Engine engine;
};

struct Scene::Impl {
  std::shared_ptr<const scene::Scene> scene;
};

struct Program::Impl {
  program::Program program;
};

struct Renderer::Impl {
  Impl(job::Engine& engine, job::ResolvedJob resolved) : job(engine, std::move(resolved), observer) {}
  job::Observer observer;  // ignores everything
  job::RenderJob job;
};

Device::Device(const DeviceOptions& options) {
  gpu::prepareDriverEnvironment();
  LogSink log;
  if (options.onWarning)
    log = [warn = options.onWarning](LogLevel level, const std::string& text) {
      if (level == LogLevel::warning) warn(text);
    };
  impl_ = std::make_unique<Impl>(job::EngineOptions{options.choice, options.cacheFolder, std::move(log)});
  impl_->engine.context();
}
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;
Device::~Device() = default;

std::string Device::name() const { return impl_->engine.context().info().name; }
std::string Device::driver() const { return impl_->engine.context().info().driver; }

Scene Scene::load(const std::filesystem::path& file) {
  Scene result;
  result.impl_ = std::make_shared<const Impl>(Impl{std::make_shared<const scene::Scene>(scene::loadScene(file))});
  return result;
}

Scene Scene::of(const Program& program) {
  Scene result;
  result.impl_ = std::make_shared<const Impl>(
      Impl{std::make_shared<const scene::Scene>(job::loadScene(job::chooseSceneSource({}, program.impl_->program)))});
  return result;
}

std::string Scene::name() const { return impl_->scene->name; }
std::size_t Scene::instanceCount() const { return impl_->scene->instances.size(); }
std::size_t Scene::cameraCount() const { return impl_->scene->cameras.size(); }

std::array<std::array<float, 3>, 2> Scene::bounds() const {
  const Bounds3 b = scene::worldBounds(*impl_->scene);
  return {{{b.min.x, b.min.y, b.min.z}, {b.max.x, b.max.y, b.max.z}}};
}

Program Program::load(const std::string& nameOrPath) {
  Program result;
  result.impl_ = std::make_shared<const Impl>(Impl{program::loadProgram(nameOrPath)});
  return result;
}

std::vector<std::string> Program::builtIn() { return program::builtInPrograms(); }
std::string Program::name() const { return impl_->program.name; }
std::string Program::description() const { return impl_->program.description; }

std::vector<ParameterInfo> Program::parameters() const {
  std::vector<ParameterInfo> result;
  for (const program::Parameter& p : impl_->program.parameters)
    result.push_back(
        {p.name, std::string(program::typeName(p.type)), program::formatDefault(p), p.min, p.max, p.unit, p.help});
  return result;
}

std::vector<std::string> Program::outputs() const { return program::outputNames(impl_->program); }

std::vector<Diagnostic> checkProgram(const Program& program, const Scene* scene) {
  const shader::Compiler compiler{shader::CompilerOptions{}};
  std::optional<program::SceneFacts> facts;
  if (scene) facts = check::sceneFacts(*scene->impl_->scene);
  return check::checkWithOptionalOutputs(program.impl_->program, compiler, facts ? &*facts : nullptr,
                                         check::DeviceLimits{})
      .diagnostics;
}

namespace {

vec3 toVec3(const std::array<float, 3>& v) { return {v[0], v[1], v[2]}; }

job::RenderRequest requestOf(const Settings& settings, std::shared_ptr<const scene::Scene> scene) {
  if (settings.width == 0 || settings.height == 0)
    throw UsageError("an image has at least one pixel in each direction");
  job::RenderRequest request;
  request.loadedScene = std::move(scene);
  request.size = {settings.width, settings.height};
  request.seed = settings.seed;
  for (const auto& [name, value] : settings.parameters) request.assignments.push_back(name + "=" + value);
  if (settings.camera) {
    const Camera& camera = *settings.camera;
    request.camera.lookFrom = toVec3(camera.lookFrom);
    request.camera.lookAt = toVec3(camera.lookAt);
    request.camera.up = toVec3(camera.up);
    request.camera.verticalFov = glm::degrees(camera.verticalFov);
    request.camera.apertureRadius = camera.apertureRadius;
  }
  return request;
}

}  // namespace

Renderer::Renderer(Device& device, const Scene& scene, const Program& program, const Settings& settings) {
  impl_ = std::make_unique<Impl>(device.impl_->engine,
                                 job::resolve(requestOf(settings, scene.impl_->scene), program.impl_->program));
}
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer::~Renderer() = default;

void Renderer::render(std::uint32_t count) {
  if (count == 0) return;
  job::RenderLimits limits;
  limits.samples = sampleCount() + count;
  impl_->job.run(limits, impl_->observer);
}

std::uint64_t Renderer::sampleCount() const { return impl_->job.renderer().statistics().samples; }

Image Renderer::image(const std::string& output) const {
  const render::Renderer& renderer = impl_->job.renderer();
  const std::vector<std::string> outputs = program::outputNames(renderer.program());
  const auto found = output.empty() ? outputs.begin() : std::ranges::find(outputs, output);
  if (found == outputs.end())
    throw UsageError(fmt::format("output '{}' not found; available: {}", output, fmt::join(outputs, ", ")));
  const auto index = static_cast<std::size_t>(found - outputs.begin());
  if (!renderer.film().stores(index)) throw UsageError(fmt::format("output '{}' was not rendered", output));
  const io::Image image = renderer.image(index);
  const std::span<const float> samples = image.samples<float>();
  return {image.width,
          image.height,
          {samples.begin(), samples.end()},
          renderer.program().outputs[index].kind == program::OutputKind::color};
}

}  // namespace quintet
