// SPDX-License-Identifier: Apache-2.0
// Completions for shells from the tables of options: names of commands and options, values, and files by extension.
#ifndef QUINTET_COMMANDS_COMPLETION_H
#define QUINTET_COMMANDS_COMPLETION_H

#include <string>

namespace quintet::cli {

std::string bashCompletion();
std::string zshCompletion();
std::string fishCompletion();

}  // namespace quintet::cli
#endif
