// The options of `quintet run`, checked as far as they can be without the program.
#ifndef QUINTET_APP_RUN_OPTIONS_H
#define QUINTET_APP_RUN_OPTIONS_H

#include "render_options.h"

namespace quintet::app {

struct RunOptions {
  RenderOptions render;
  bool list = false;       // the built-in programs
  bool allFrames = false;  // write each, not only the last one
  bool watch = false;      // render again whenever a file is saved
};

// Nothing: help was printed. Throws UsageError. `render.output` is empty unless -o was given;
// `render.programHelp`: --help together with a program.
std::optional<RunOptions> parseRunOptions(Arguments arguments);

}  // namespace quintet::app
#endif
