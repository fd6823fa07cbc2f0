// SPDX-License-Identifier: Apache-2.0
// A small image with run-time checks in the shaders: `quintet check --instrument`.
#ifndef QUINTET_JOB_INSTRUMENTED_RUN_H
#define QUINTET_JOB_INSTRUMENTED_RUN_H

#include <vector>

#include "base/diagnostic.h"
#include "job/engine.h"
#include "job/observer.h"
#include "program/description/program.h"
#include "scene/model/scene.h"

namespace quintet::job {

// Renders 96x64 pixels, one batch or two frames, and returns what the checks found (docs/diagnostics, Q001 to Q006). A
// launch that does not end within 20 s is reported by Observer::deviceHung(). Throws ProgramError and gpu errors.
std::vector<Diagnostic> runInstrumented(Engine& engine, const program::Program& program, scene::Scene scene,
                                        Observer& observer);

}  // namespace quintet::job
#endif
