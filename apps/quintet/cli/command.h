// SPDX-License-Identifier: Apache-2.0
// The commands of `quintet`. `scripts/new command NAME` adds one.
#ifndef QUINTET_CLI_COMMAND_H
#define QUINTET_CLI_COMMAND_H

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quintet::cli {

// The arguments after the command's name.
using Arguments = std::span<const std::string>;

class OptionTable;

struct Command {
  std::string_view name;               // one word, or two for a command of a group: "farm plan"
  std::string_view summary;            // one line for `quintet --help`
  int (*run)(Arguments) = nullptr;     // returns the exit status; exceptions become 1 or 2 in main
  OptionTable (*options)() = nullptr;  // for documentation: without targets
  bool isolated = false;               // compiles or runs programs: works in a child process (cli/supervisor.h)
};

std::span<const Command> commands();

// The command that the first words of a command line name ("farm plan" or "farm-plan"), and the number of these words; null if there is none.
struct NamedCommand {
  const Command* command = nullptr;
  std::size_t words = 0;
};
NamedCommand commandNamed(Arguments words);
// The name of a command as one word: "farm-plan", for files and functions of shells. It is accepted as well.
std::string commandKey(std::string_view name);
// The first words of the names, and for a group the second words of its commands; each once, in their order.
std::vector<std::string> commandWords();
std::vector<std::string> commandGroups();                       // the first words of commands with two
std::vector<std::string> commandWords(std::string_view group);  // empty if it is no group

int renderCommand(Arguments);
int mergeCommand(Arguments);
int farmPlanCommand(Arguments);
int farmRunCommand(Arguments);
int farmMergeCommand(Arguments);
int farmStatusCommand(Arguments);
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
int licensesCommand(Arguments);
int helpCommand(Arguments);

OptionTable renderOptions();
OptionTable mergeOptions();
OptionTable farmPlanOptions();
OptionTable farmRunOptions();
OptionTable farmMergeOptions();
OptionTable farmStatusOptions();
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
OptionTable licensesOptions();
OptionTable helpOptions();

}  // namespace quintet::cli
#endif
