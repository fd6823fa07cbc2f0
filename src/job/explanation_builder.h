// SPDX-License-Identifier: Apache-2.0
// Makes the tree of a PixelExplanation from the records of the shader log.
#ifndef QUINTET_JOB_EXPLANATION_BUILDER_H
#define QUINTET_JOB_EXPLANATION_BUILDER_H

#include <span>
#include <string>
#include <vector>

#include "job/pixel_explanation.h"
#include "program/runnable_program.h"
#include "render/renderer/shader_log.h"

namespace quintet::job {

// The names of objects in the scene, by index.
struct SceneNames {
  std::span<const std::string> instances;
  std::span<const std::string> materials;
  std::span<const std::string> lights;  // the first entries of the light table: point, spot and directional lights
};

// `program` is the instrumented program that wrote the log (Instrumentation::explain), and `pixel` the pixel of the log.
// Records that are incomplete or out of order, because others did not fit, are skipped.
std::vector<ExplainedEvent> buildEvents(const render::LogContents& log, const program::RunnableProgram& program,
                                        const SceneNames& names, uvec2 pixel);

}  // namespace quintet::job
#endif
