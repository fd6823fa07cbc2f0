// CLI11 with our manners: errors are UsageErrors of one line that name the nearest option, help goes to
// standard output. Slow to compile: included only where options are declared.
#ifndef QUINTET_APP_CLI_H
#define QUINTET_APP_CLI_H

#include <string>

#include <CLI/CLI.hpp>

#include "commands.h"

namespace quintet::app {

// Prepares `app`, named "quintet render". `examples`: one a line.
void setUp(CLI::App& app, const std::string& examples);

// False: --help was asked for and printed.
bool parse(CLI::App& app, Arguments arguments);

}  // namespace quintet::app
#endif
