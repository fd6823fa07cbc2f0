// SPDX-License-Identifier: Apache-2.0
// Finds the operation in the source of a program that made a value NaN or infinite, by rendering a pixel again with a variant
// of the program that checks its operations (quintet/values.glsl).
#ifndef QUINTET_JOB_VALUE_ORIGIN_H
#define QUINTET_JOB_VALUE_ORIGIN_H

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "job/engine.h"
#include "job/pixel_explanation.h"
#include "program/description/program.h"
#include "program/probes.h"
#include "render/renderer/renderer.h"
#include "render/renderer/shader_log.h"

namespace quintet::job {

class ValueOriginFinder {
 public:
  // For the pixel, of renders of `program` with these settings; `outputs` are those of RenderRequest::outputs. Compiles the
  // variant. Throws ProgramError and gpu errors.
  ValueOriginFinder(Engine& engine, render::DeviceScene& scene, const program::Program& program,
                    const std::vector<std::string>& outputs, render::RenderSettings settings, uvec2 pixel);

  // Calls `render`, which renders samples or frames of the pixel, with the renderer of the variant. Returns the first operation
  // in a file of the program, or if there is none in the library; nothing if all results are finite.
  std::optional<ValueOrigin> find(const std::function<void(render::Renderer&)>& render);

 private:
  render::ShaderLog log_;
  std::vector<program::ValueSite> sites_;
  std::unique_ptr<render::Renderer> renderer_;
};

}  // namespace quintet::job
#endif
