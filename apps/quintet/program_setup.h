// The program that renders, its parameters from options, and what `--help-program` says about it.
#ifndef QUINTET_APP_PROGRAM_SETUP_H
#define QUINTET_APP_PROGRAM_SETUP_H

#include <string>

#include "program/program.h"
#include "render_options.h"

namespace quintet::app {

// Defaults, then --set in order, then --bounces and --clamp. Throws UsageError.
program::ParameterValues parameterValues(const program::Program& program, const RenderOptions& options);

std::string programHelp(const program::Program& program);

// As asked for; else neutral for colour, linear for other quantities (normals, occlusion).
render::ToneMap chooseToneMap(const program::Program& program, const RenderOptions& options);

}  // namespace quintet::app
#endif
