// SPDX-License-Identifier: Apache-2.0
// Commands that compile or run programs work in a child process. A crash of the driver or of the compiler (of any thread,
// also with a full stack) then ends with one error and an exit status, not with a signal. The parent only waits: it
// forwards SIGINT and SIGTERM, and ends with the child's exit status. If the parent is killed, so is the child.
// With --watch, a crash is not the end: when one of the child's files (cli/work.h) is saved, the parent starts a new child.
#ifndef QUINTET_CLI_SUPERVISOR_H
#define QUINTET_CLI_SUPERVISOR_H

#include <optional>
#include <span>
#include <string>

namespace quintet::cli {

// Starts the child, before other threads exist. Returns nullopt in the child, and the exit status in the parent after the
// child has ended. Returns nullopt without a child if the environment variable QUINTET_ISOLATION is "off" (for debuggers)
// or if no process can be created. `arguments` are those of the process, with the command.
std::optional<int> supervise(std::span<const std::string> arguments);

// In a child: an earlier child has crashed, and one of its files was then saved.
bool restartedAfterCrash();

}  // namespace quintet::cli
#endif
