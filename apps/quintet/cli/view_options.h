// SPDX-License-Identifier: Apache-2.0
// The options of `quintet view` and of the program `quintet-view`, which shows the window.
#ifndef QUINTET_CLI_VIEW_OPTIONS_H
#define QUINTET_CLI_VIEW_OPTIONS_H

#include <optional>
#include <string>

#include "cli/command.h"
#include "cli/option_table.h"
#include "cli/render_options.h"

namespace quintet::cli {

struct ViewOptions : RenderOptions {
  std::string script;      // empty: a window
  bool keepGoing = false;  // with a script
  // Of the window.
  std::string presentDevice;  // empty means the first one that can
  std::string scaleText;
  std::optional<float> scale;  // size of text and controls; parsed from scaleText
  std::string theme;           // "dark", "light" or empty
  std::string windowSize;      // "WxH"; empty means that of the settings
  std::string events;          // file for the events as lines of JSON; empty means none
  bool noSettings = false;     // neither read nor write the user's settings
  bool startScreen = false;    // neither scene nor program was given
};

OptionTable viewOptionTable(ViewOptions& options, RenderTexts& texts);

// Empty: --help was requested and printed. Throws UsageError.
std::optional<ViewOptions> parseViewOptions(Arguments arguments);

}  // namespace quintet::cli
#endif
