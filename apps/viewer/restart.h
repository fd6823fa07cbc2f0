// SPDX-License-Identifier: Apache-2.0
// Replaces the process by a new one with the same scene. Threads of a driver that work on an endless launch end only with
// their process.
#ifndef QUINTET_APPS_VIEWER_RESTART_H
#define QUINTET_APPS_VIEWER_RESTART_H

#include <optional>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"

namespace quintet::viewer {

// What the new process gets besides its arguments.
struct RestartNote {
  std::vector<std::string> script;      // SessionThread::open()
  std::string error;                    // why the new process waits for a save; empty if it opens the scene at once
  std::vector<Diagnostic> diagnostics;  // with `error`
  std::optional<glm::ivec2> position;   // of the window, screen coordinates
};

// Does not return, unless the process cannot be replaced: then it returns the error. No destructor runs.
std::string restartProcess(const std::vector<std::string>& arguments, const RestartNote& note);

// The note of the process that this one has replaced; nothing if it was started in another way.
std::optional<RestartNote> takeRestartNote();

}  // namespace quintet::viewer
#endif
