// SPDX-License-Identifier: Apache-2.0
// The terminal that a standard stream may be.
#ifndef QUINTET_CLI_TERMINAL_H
#define QUINTET_CLI_TERMINAL_H

#include <cstddef>
#include <optional>

namespace quintet::cli {

// Columns of the terminal; empty for a file or a pipe.
std::optional<std::size_t> terminalWidth(int descriptor);

}  // namespace quintet::cli
#endif
