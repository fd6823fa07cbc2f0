// SPDX-License-Identifier: Apache-2.0
// The command line that renders the image of a session again.
#ifndef QUINTET_APPS_VIEWER_REPRODUCE_H
#define QUINTET_APPS_VIEWER_REPRODUCE_H

#include <string>

#include "viewer/session_thread.h"

namespace quintet::viewer {

// For a snapshot with Phase::ready. Edits of materials, lights and objects become a script for 'quintet view'.
std::string reproducingCommand(const Snapshot& snapshot);

}  // namespace quintet::viewer
#endif
