// SPDX-License-Identifier: Apache-2.0
// Exit statuses of all commands (docs/cli.md).
#ifndef QUINTET_CLI_EXIT_STATUS_H
#define QUINTET_CLI_EXIT_STATUS_H

namespace quintet::cli {

// docs/cli.md, "Output, errors and exit status".
constexpr int kRuntimeError = 1;
constexpr int kWrongCommandLine = 2;
constexpr int kTargetNotReached = 3;
constexpr int kCrashed = 4;
constexpr int kWrongVersion = 5;

}  // namespace quintet::cli
#endif
