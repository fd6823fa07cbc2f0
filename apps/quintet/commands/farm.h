// SPDX-License-Identifier: Apache-2.0
// What the commands of `quintet farm` share: the options of a planned render.
#ifndef QUINTET_COMMANDS_FARM_H
#define QUINTET_COMMANDS_FARM_H

#include <filesystem>
#include <string>
#include <vector>

#include "cli/option_table.h"
#include "cli/render_options.h"
#include "farm/plan.h"

namespace quintet::cli {

// The options of a plan that its render gets.
void declarePlanned(OptionTable& table, RenderTexts& texts, RenderOptions& options);

// From texts whose scene is set. `frames`: the output is one image per frame. Throws UsageError.
void convertPlanned(RenderTexts& texts, RenderOptions& options, const std::filesystem::path& image, bool frames);

// The options that a plan stores. Throws UsageError.
RenderOptions plannedOptions(const farm::Plan& plan);

}  // namespace quintet::cli
#endif
