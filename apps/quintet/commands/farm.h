// SPDX-License-Identifier: Apache-2.0
// What the commands of `quintet farm` share: their argument PLAN, and the options of a planned render.
#ifndef QUINTET_COMMANDS_FARM_H
#define QUINTET_COMMANDS_FARM_H

#include <filesystem>

#include "cli/option_table.h"
#include "cli/render_options.h"
#include "farm/plan.h"

namespace quintet::cli {

// The argument PLAN of a command.
Option planArgument(std::filesystem::path& plan);

// Declares the options of `farm plan` that the plan stores for its render.
void declarePlanned(OptionTable& table, RenderTexts& texts, RenderOptions& options);

// Converts them from texts whose scene is set. `frames`: the output is one image per frame. Throws UsageError.
void convertPlanned(RenderTexts& texts, RenderOptions& options, const std::filesystem::path& image, bool frames);

// Returns the options that a plan stores. Throws UsageError.
RenderOptions plannedOptions(const farm::Plan& plan);

}  // namespace quintet::cli
#endif
