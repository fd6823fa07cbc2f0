// SPDX-License-Identifier: Apache-2.0
// Programs that belong to `quintet` but need more of the system, such as a window: a command starts them as git starts
// its subcommands.
#ifndef QUINTET_CLI_COMPANION_H
#define QUINTET_CLI_COMPANION_H

#include <filesystem>
#include <span>
#include <string>

namespace quintet::cli {

// The executable of this name in the folder of this process's executable, else in PATH; empty if there is none.
std::filesystem::path findCompanion(const std::string& name);

// Replaces this process by the program. Returns only by throwing FileError.
[[noreturn]] void startCompanion(const std::filesystem::path& program, std::span<const std::string> arguments);

}  // namespace quintet::cli
#endif
