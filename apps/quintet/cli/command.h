// SPDX-License-Identifier: Apache-2.0
// The commands of `quintet`. To add one, write commands/NAME.cpp and add a row to commands/command.cpp.
#ifndef QUINTET_CLI_COMMAND_H
#define QUINTET_CLI_COMMAND_H

#include <span>
#include <string>
#include <string_view>

namespace quintet::cli {

// The arguments after the command's name.
using Arguments = std::span<const std::string>;

class OptionTable;

struct Command {
  std::string_view name;
  std::string_view summary;            // one line for `quintet --help`
  int (*run)(Arguments) = nullptr;     // returns the exit status; exceptions become 1 or 2 in main
  OptionTable (*options)() = nullptr;  // for documentation: without targets
  bool isolated = false;               // compiles or runs programs: works in a child process (cli/supervisor.h)
};

std::span<const Command> commands();

int renderCommand(Arguments);
int mergeCommand(Arguments);
int runCommand(Arguments);
int newCommand(Arguments);
int checkCommand(Arguments);
int explainCommand(Arguments);
int explainPixelCommand(Arguments);
int findCommand(Arguments);
int infoCommand(Arguments);
int compareCommand(Arguments);
int benchCommand(Arguments);
int viewCommand(Arguments);
int labCommand(Arguments);
int helpCommand(Arguments);

OptionTable renderOptions();
OptionTable mergeOptions();
OptionTable runOptions();
OptionTable newOptions();
OptionTable checkOptions();
OptionTable explainOptions();
OptionTable explainPixelOptions();
OptionTable findOptions();
OptionTable infoOptions();
OptionTable compareOptions();
OptionTable benchOptions();
OptionTable viewOptions();
OptionTable labOptions();
OptionTable helpOptions();

}  // namespace quintet::cli
#endif
