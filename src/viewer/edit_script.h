// SPDX-License-Identifier: Apache-2.0
// What the user has changed in a session, as lines of a script (docs/viewer.md).
#ifndef QUINTET_VIEWER_EDIT_SCRIPT_H
#define QUINTET_VIEWER_EDIT_SCRIPT_H

#include <string>
#include <vector>

#include "viewer/snapshot.h"

namespace quintet::viewer {

// Edits of materials, lights and objects, and the frame: all that a request (interactive::withState) and the commands
// `render` and `run` have no option for. For a snapshot with Phase::ready.
std::vector<std::string> editScript(const Snapshot& snapshot);
// The output, the exposure and the tone mapping, if they are not the defaults.
std::vector<std::string> displayScript(const Snapshot& snapshot);

}  // namespace quintet::viewer
#endif
