// SPDX-License-Identifier: Apache-2.0
// CLI11 with Quintet's conventions: errors are UsageErrors of one line that name the nearest option, and help goes to
// standard output. Slow to compile: included only where options are declared.
#ifndef QUINTET_CLI_PARSER_H
#define QUINTET_CLI_PARSER_H

#include <string>

#include <CLI/CLI.hpp>

#include "cli/command.h"

namespace quintet::cli {

// Prepares `app`, named "quintet render". `examples`: one per line.
void setUp(CLI::App& app, const std::string& examples);

// False: --help was requested and printed. Throws UsageError.
bool parse(CLI::App& app, Arguments arguments);

}  // namespace quintet::cli
#endif
