// SPDX-License-Identifier: Apache-2.0
// A short render with run-time checks in the shaders: `quintet check --instrument`.
#ifndef QUINTET_JOB_INSTRUMENTED_RUN_H
#define QUINTET_JOB_INSTRUMENTED_RUN_H

#include <functional>
#include <vector>

#include "base/diagnostic.h"
#include "job/engine.h"
#include "job/request.h"
#include "program/description/program.h"
#include "scene/model/scene.h"

namespace quintet::job {

// Renders with the view, size, region, seed, parameters and number of samples (or frames) of the request, and returns
// what the checks found (docs/diagnostics, Q001 to Q007). The defaults are 96x64 pixels, and one batch or two frames.
// `hung` is called as Observer::deviceHung() if a launch does not end in time. Throws
// UsageError, FileError, ProgramError and gpu errors.
std::vector<Diagnostic> runInstrumented(Engine& engine, const program::Program& program, scene::Scene scene,
                                        const RenderRequest& request,
                                        const std::function<void(const Diagnostic&)>& hung);

}  // namespace quintet::job
#endif
