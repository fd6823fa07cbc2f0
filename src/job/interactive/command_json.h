// SPDX-License-Identifier: Apache-2.0
// Commands of sessions as JSON objects: {"do":"orbit","dx":30,"dy":0}. docs/viewer.md lists them.
#ifndef QUINTET_JOB_INTERACTIVE_COMMAND_JSON_H
#define QUINTET_JOB_INTERACTIVE_COMMAND_JSON_H

#include <string>
#include <vector>

#include "job/interactive/command.h"
#include "job/interactive/json_fields.h"

namespace quintet::job::interactive {

// Values of "do".
std::vector<std::string> commandNames();

// The command `name` with the other members of the object. Throws UsageError for unknown names and members, and for
// values of the wrong type. `moreNames`: values of "do" that the caller handles itself, for messages.
Command parseCommand(const std::string& name, JsonFields& fields, const std::vector<std::string>& moreNames = {});

}  // namespace quintet::job::interactive
#endif
