// From options to what the program gets: its parameters' values, and the curve that its pictures are shown with.
#ifndef QUINTET_APP_PROGRAM_SETUP_H
#define QUINTET_APP_PROGRAM_SETUP_H

#include <string>

#include "program/program.h"
#include "render_options.h"

namespace quintet::app {

// Defaults, then --set-file, --set in order, then --bounces and --clamp. Throws UsageError.
program::ParameterValues parameterValues(const program::Program& program, const RenderOptions& options);

// As asked for; else neutral for an output of kind color, linear for other quantities (normals, occlusion).
render::ToneMap chooseToneMap(const program::Output& output, const RenderOptions& options);

}  // namespace quintet::app
#endif
