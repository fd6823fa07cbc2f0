// SPDX-License-Identifier: Apache-2.0
// How a command fails: its exit status, one line on standard error, and with --json one object on standard output.
#ifndef QUINTET_CLI_FAILURE_H
#define QUINTET_CLI_FAILURE_H

#include <exception>
#include <string>

#include "base/error.h"

namespace quintet::cli {

// docs/cli.md, "Output, errors and exit status".
constexpr int kRuntimeError = 1;
constexpr int kWrongCommandLine = 2;
constexpr int kTargetNotReached = 3;

// The end of an error message that names the option: "; use --force to overwrite it". Empty for Remedy::none.
std::string optionHint(Remedy remedy);

// Prints "quintet: MESSAGE" on one line. Returns `status`.
int printFailure(std::string message, int status);

// Prints the error with the option that helps, with `json` also as an object. Returns the exit status.
int reportFailure(const std::exception& error, bool json);

}  // namespace quintet::cli
#endif
