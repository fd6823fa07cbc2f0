// SPDX-License-Identifier: Apache-2.0
#include "job/picking_program.h"

#include <fmt/format.h>

#include "job/device_limits.h"
#include "job/runnable_program.h"
#include "program/load.h"
#include "render/renderer/render_settings.h"

namespace quintet::job {

program::Program describePicking(const program::Program& shown, const char* rayGeneration) {
  program::Program program = program::loadProgram("pick");
  program.rayGeneration = rayGeneration;
  // With as many ray types as the shown program, so that both use the same acceleration structure.
  while (program.rays.size() < shown.rays.size()) {
    program::RayType unused = program.rays.front();
    unused.name = fmt::format("unused{}", program.rays.size());
    program.rays.push_back(unused);
  }
  program.keepsInstanceOrder = shown.keepsInstanceOrder;
  program.anyHitForAll = shown.anyHitForAll;
  return program;
}

program::RunnableProgram pickingProgram(Engine& engine, const render::DeviceScene& scene, const program::Program& shown,
                                        const char* rayGeneration) {
  return compileAndCheck(describePicking(shown, rayGeneration), engine.compiler(),
                         render::renderDefines(scene.defines(), {}), scene.facts(),
                         deviceLimits(engine.context().info()))
      .runnable;
}

}  // namespace quintet::job
