// SPDX-License-Identifier: Apache-2.0
#ifndef QUINTET_COMMANDS_HELP_H
#define QUINTET_COMMANDS_HELP_H

#include <string>
#include <string_view>

namespace quintet::cli {

// `quintet --help`: the commands.
std::string overviewText();

// "unknown command 'rendr' (did you mean 'render'?); …"
// `second`: the word after the name of a group of commands, if there is one.
std::string unknownCommandText(std::string_view name, std::string_view second = {});

// `quintet farm --help`: the commands of a group.
std::string groupText(std::string_view group);

}  // namespace quintet::cli
#endif
