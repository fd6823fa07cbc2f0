// SPDX-License-Identifier: Apache-2.0
// The built-in program `pick`, prepared for the scene of a different program.
#ifndef QUINTET_JOB_PICKING_PROGRAM_H
#define QUINTET_JOB_PICKING_PROGRAM_H

#include "job/engine.h"
#include "program/description/program.h"
#include "program/runnable_program.h"
#include "render/scene/device_scene.h"

namespace quintet::job {

// `shown`: the program for which the scene is prepared. The result uses the same acceleration structures.
// `rayGeneration`: a file of the program `pick`.
program::Program describePicking(const program::Program& shown, const char* rayGeneration = "pick.rgen");
// The same, compiled. Throws ProgramError.
program::RunnableProgram pickingProgram(Engine& engine, const render::DeviceScene& scene, const program::Program& shown,
                                        const char* rayGeneration = "pick.rgen");

}  // namespace quintet::job
#endif
