// What `quintet run` draws and writes: one picture, or frame after frame.
#ifndef QUINTET_APP_RUN_PICTURES_H
#define QUINTET_APP_RUN_PICTURES_H

#include <functional>
#include <string>

#include "run_options.h"
#include "session.h"
#include "signals.h"

namespace quintet::app {

// What --watch adds; each may be empty.
struct PictureHooks {
  std::function<bool()> abandon;                         // asked between launches: nothing more is written
  std::function<void(const std::string&)> firstPicture;  // the first picture is written, perhaps a rough one
};

enum class PictureEnd { complete, interrupted, abandoned };

// Draws with session.renderer(), which has drawn nothing yet, and writes the files; the report is left.
PictureEnd drawPictures(Session& session, const RunOptions& options, const GracefulStop& stop,
                        const PictureHooks& hooks = {});

}  // namespace quintet::app
#endif
