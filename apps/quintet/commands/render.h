// SPDX-License-Identifier: Apache-2.0
// One render from options to files on disk: what `render` does, and `run` without --watch.
#ifndef QUINTET_COMMANDS_RENDER_H
#define QUINTET_COMMANDS_RENDER_H

#include <atomic>
#include <optional>
#include <string>

#include "base/stopwatch.h"
#include "cli/render_options.h"
#include "job/engine.h"
#include "job/resolve.h"
#include "job/result.h"
#include "output/plan.h"

namespace quintet::cli {

// The devices that several renders use, one after the other. Messages of the drivers go to the console of the current
// render.
class RenderDevices {
 public:
  class Use {  // by a render
   public:
    Use(RenderDevices& devices, Console& console) : devices_(devices) { devices_.console_ = &console; }
    ~Use() { devices_.console_ = nullptr; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    RenderDevices& devices_;
  };
  // The devices of the options. The first call begins to open them.
  job::Engine& engine(const RenderOptions& options);

 private:
  std::atomic<Console*> console_{nullptr};
  std::optional<job::Engine> engine_;
};

// `clock`: started with the command. Returns the exit status.
int renderImages(const RenderOptions& options, const program::Program& named, const Stopwatch& clock,
                 RenderDevices& devices);
int renderImages(const RenderOptions& options, const program::Program& named, const Stopwatch& clock);

// Parameters and outputs of the program, and the options of `command` ("render", "run") that set and select them.
std::string programHelpText(const program::Program& program, std::string_view command);

// Prints warnings about the result, and adds all warnings of the render to it.
void addWarnings(job::RenderResult& result, Console& console);

// The request of the options for this program, with what the plan requires of the render.
job::RenderRequest requestFor(const RenderOptions& options, const output::OutputPlan& plan);

}  // namespace quintet::cli
#endif
