// SPDX-License-Identifier: Apache-2.0
// Parses the arguments of a command. Only parser.cpp includes the library (CLI11), which is slow to compile.
#ifndef QUINTET_CLI_PARSER_H
#define QUINTET_CLI_PARSER_H

#include "cli/command.h"
#include "cli/option_table.h"

namespace quintet::cli {

// Sets the targets of the table. False: --help was requested and printed. Throws UsageError, which names the option, the
// expected value and the nearest name.
bool parse(const OptionTable& table, Arguments arguments);

}  // namespace quintet::cli
#endif
