// SPDX-License-Identifier: Apache-2.0
// Commands of sessions as JSON objects: {"do":"orbit","dx":30,"dy":0}. session_protocol.json describes them.
#ifndef QUINTET_JOB_INTERACTIVE_COMMAND_JSON_H
#define QUINTET_JOB_INTERACTIVE_COMMAND_JSON_H

#include <cstdint>
#include <string>
#include <string_view>

#include "base/math.h"
#include "job/interactive/command.h"
#include "job/interactive/message_schema.h"

namespace quintet::job::interactive {

std::string_view sessionProtocol();  // session_protocol.json
const MessageSchema& sessionSchema();
const MessageSchema& scriptSchema();  // with what only scripts have: script_protocol.json

// The command of a message that one of the schemas has read.
Command parseCommand(const nlohmann::json& message);

// Parts of such messages.
CameraRequest parseCamera(const nlohmann::json& message);  // "from", "at", "up", "fov", "aperture", "focus"
uvec2 parsePixel(const nlohmann::json& message);           // "x" and "y". Throws UsageError if one is missing
std::string assignedValue(const nlohmann::json& value);    // as in "name=value": "3", "true", "0.5,1,0"

}  // namespace quintet::job::interactive
#endif
