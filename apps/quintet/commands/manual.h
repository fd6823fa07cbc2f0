// SPDX-License-Identifier: Apache-2.0
// Man pages from the tables of options: quintet(1), and one page for each command.
#ifndef QUINTET_COMMANDS_MANUAL_H
#define QUINTET_COMMANDS_MANUAL_H

#include <string>

#include "cli/option_table.h"

namespace quintet::cli {

// quintet-COMMAND(1), in roff.
std::string manualPage(const OptionTable& table);

// quintet(1): the commands, exit statuses and environment variables.
std::string mainManualPage();

}  // namespace quintet::cli
#endif
