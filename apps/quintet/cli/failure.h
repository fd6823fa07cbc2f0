// SPDX-License-Identifier: Apache-2.0
// How a command fails: its exit status, one line on standard error, and with --json the error on standard output.
#ifndef QUINTET_CLI_FAILURE_H
#define QUINTET_CLI_FAILURE_H

#include <exception>
#include <filesystem>
#include <span>
#include <string>

#include "base/error.h"
#include "cli/exit_status.h"

namespace quintet::cli {

// The end of an error message that names the option: "; use --force to overwrite it". Empty for Remedy::none.
std::string optionHint(Remedy remedy);

// What a command that fails prints on standard output.
enum class FailureJson { none, object, diagnostics };

// By the arguments of the process, also if the command line cannot be parsed: with --json one object, `check` an array of
// diagnostics. After "--", --json is the name of a file.
FailureJson failureJson(std::span<const std::string> arguments);

// Prints "quintet: MESSAGE"; line breaks in it become spaces. Returns `status`.
int printFailure(std::string message, int status);

// Prints the error with the option that helps, also as JSON. `hint`: appended to the message, for example "; write 'x'".
// `scene`: one of several that the command renders; the message names it. Returns the exit status.
int reportFailure(const std::exception& error, FailureJson json, const std::string& hint = {},
                  const std::filesystem::path& scene = {});
// The status of a command that this error ends.
int failureStatus(const std::exception& error);

}  // namespace quintet::cli
#endif
