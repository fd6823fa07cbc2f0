// The commands of `quintet`. A new one is a file of its own and a line in commands.cpp.
#ifndef QUINTET_APP_COMMANDS_H
#define QUINTET_APP_COMMANDS_H

#include <span>
#include <string>
#include <string_view>

namespace quintet::app {

// What follows the command's name.
using Arguments = std::span<const std::string>;

struct Command {
  std::string_view name;
  std::string_view summary;         // one line for `quintet --help`
  int (*run)(Arguments) = nullptr;  // returns the exit status; throws what main turns into 1 or 2
};

std::span<const Command> commands();

int renderCommand(Arguments);   // render.cpp
int mergeCommand(Arguments);    // merge.cpp
int runCommand(Arguments);      // run.cpp
int newCommand(Arguments);      // new.cpp
int checkCommand(Arguments);    // check.cpp
int explainCommand(Arguments);  // explain.cpp
int infoCommand(Arguments);     // info.cpp
int compareCommand(Arguments);  // compare.cpp
int benchCommand(Arguments);    // bench.cpp

}  // namespace quintet::app
#endif
