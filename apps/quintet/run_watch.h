// `quintet run --watch`: renders, waits for a saved file, renders again, until Ctrl-C.
#ifndef QUINTET_APP_RUN_WATCH_H
#define QUINTET_APP_RUN_WATCH_H

#include "run_options.h"
#include "session.h"

namespace quintet::app {

// A program that does not compile is told and waited for; the first errors of another kind throw. Device, scene and
// acceleration structures stay as long as the scene's files do. Returns the exit status.
int watchProgram(Session& session, const RunOptions& options);

}  // namespace quintet::app
#endif
