// SPDX-License-Identifier: Apache-2.0
// The terminal that a standard stream may be.
#ifndef QUINTET_CLI_TERMINAL_H
#define QUINTET_CLI_TERMINAL_H

#include <cstddef>
#include <optional>
#include <string>

namespace quintet::cli {

// Columns of the terminal; empty for a file or a pipe.
std::optional<std::size_t> terminalWidth(int descriptor);

// Prints to standard error. A job continues when its terminal is closed or the reader of a pipe has ended, where fmt::print
// would throw.
void printError(const std::string& text);

// A terminal, and neither NO_COLOR (no-color.org) nor TERM=dumb is set.
bool colorOnStandardError();

}  // namespace quintet::cli
#endif
