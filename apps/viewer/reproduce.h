// SPDX-License-Identifier: Apache-2.0
// The command lines that render the image of a session again, or explain one of its pixels.
#ifndef QUINTET_APPS_VIEWER_REPRODUCE_H
#define QUINTET_APPS_VIEWER_REPRODUCE_H

#include <cstdint>
#include <string>
#include <vector>

#include "viewer/session_thread.h"

namespace quintet::viewer {

// For a snapshot with Phase::ready. Edits of materials, lights and objects become a script for 'quintet view'.
std::string reproducingCommand(const Snapshot& snapshot);
// The arguments of 'quintet view' that open the scene again, without editScript(). Also for a session that has not been
// opened. `fixedSize`: the image keeps its size.
std::vector<std::string> viewArguments(const Snapshot& snapshot, bool fixedSize);
// `sample`: or frame. A script writes the explanation to pixel.json.
std::string explainingCommand(const Snapshot& snapshot, uvec2 pixel, std::uint32_t sample);

}  // namespace quintet::viewer
#endif
