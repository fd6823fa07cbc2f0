// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/picking.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "job/picking_program.h"
#include "program/compile.h"
#include "render/renderer/renderer.h"

namespace quintet::job::interactive {
namespace {

vec4 valueOf(const render::Renderer& renderer, const std::string& output) {
  const std::vector<std::string> names = program::outputNames(renderer.program());
  const auto index = static_cast<std::size_t>(std::ranges::find(names, output) - names.begin());
  return renderer.film().plane(index).values.at(0);
}

}  // namespace

std::optional<Pick> pick(Engine& engine, render::DeviceScene& scene, const scene::Camera& camera, uvec2 size,
                         uvec2 pixel, const program::Program& shown) {
  program::RunnableProgram program = pickingProgram(engine, scene, shown);
  render::RenderSettings settings;
  settings.width = size.x;
  settings.height = size.y;
  settings.region = {pixel.x, pixel.y, 1, 1};
  settings.camera = camera;
  settings.parameters = program::ParameterValues(program.description.parameters);
  render::Renderer renderer(scene, std::move(program), engine.compiler(), &engine.pipelineCache(), settings);
  renderer.renderBatch(1);
  renderer.finish();
  const vec4 hit = valueOf(renderer, "hit"), position = valueOf(renderer, "position"),
             normal = valueOf(renderer, "normal"), geometric = valueOf(renderer, "geometric_normal");
  if (!(hit.x > 0.0f)) return std::nullopt;
  Pick result;
  result.instance = static_cast<std::size_t>(hit.x) - 1;
  result.geometry = static_cast<std::size_t>(hit.y);
  result.primitive = static_cast<std::uint32_t>(hit.z) | static_cast<std::uint32_t>(hit.w) << 16;
  result.material = static_cast<std::size_t>(normal.w);
  result.position = vec3(position);
  result.normal = vec3(normal);
  result.geometricNormal = vec3(geometric);
  result.front = geometric.w > 0.0f;
  result.distance = position.w;
  return result;
}

std::future<void> compilePicking(Engine& engine, const render::DeviceScene& scene, const program::Program& shown) {
  return std::async(std::launch::async,
                    [&engine, program = describePicking(shown), defines = render::renderDefines(scene.defines(), {})] {
                      try {
                        program::compile(program, engine.compiler(), defines);
                      } catch (const Error&) {
                        return;  // pick() reports it
                      }
                    });
}

}  // namespace quintet::job::interactive
