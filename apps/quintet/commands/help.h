// SPDX-License-Identifier: Apache-2.0
#ifndef QUINTET_COMMANDS_HELP_H
#define QUINTET_COMMANDS_HELP_H

#include <string>
#include <string_view>

namespace quintet::cli {

// `quintet --help`: the commands.
std::string overviewText();

// "unknown command 'rendr' (did you mean 'render'?); …"
std::string unknownCommandText(std::string_view name);

}  // namespace quintet::cli
#endif
