// SPDX-License-Identifier: Apache-2.0
// The output of --help.
#ifndef QUINTET_CLI_HELP_TEXT_H
#define QUINTET_CLI_HELP_TEXT_H

#include <cstddef>
#include <string>

#include "cli/option_table.h"

namespace quintet::cli {

// Columns of help on standard output: those of the terminal, at most 100; 80 in files and pipes.
std::size_t helpWidth();

std::string helpText(const OptionTable& table, std::size_t width);

// The list under "Examples:". The texts stand next to the commands if all lines fit, else below them.
std::string examplesText(const std::vector<Example>& examples, std::size_t width);

}  // namespace quintet::cli
#endif
