// The options of `quintet merge`.
#ifndef QUINTET_APP_MERGE_OPTIONS_H
#define QUINTET_APP_MERGE_OPTIONS_H

#include <optional>
#include <string>
#include <vector>

#include "render_options.h"

namespace quintet::app {

struct MergeOptions {
  std::vector<std::string> parts;
  bool partial = false;
  bool exposureGiven = false;  // else that of the rendering
  // As for a rendering: output, exposure, tone map, OpenEXR, --all-outputs, --force, --json, --quiet.
  RenderOptions render;
};

// Nothing: help was printed. Throws UsageError.
std::optional<MergeOptions> parseMergeOptions(Arguments arguments);

}  // namespace quintet::app
#endif
