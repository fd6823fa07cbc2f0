// SPDX-License-Identifier: Apache-2.0
// `quintet-view`: shows a scene in a window. `quintet view` starts it with its arguments.
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "application.h"
#include "base/error.h"
#include "base/memory.h"
#include "cli/command.h"
#include "cli/console.h"
#include "cli/failure.h"
#include "cli/values.h"
#include "cli/view_options.h"
#include "gpu/driver_environment.h"
#include "restart.h"

namespace quintet::cli {

// The help texts of the library list the commands of the program; this one has none besides `view`.
std::span<const Command> commands() { return {}; }

}  // namespace quintet::cli

namespace quintet::viewer {
namespace {

// The file of --events, as lines that are written at once.
class EventFile {
 public:
  EventFile(const std::string& name, bool appends) : file_(name, appends ? std::ios::app : std::ios::trunc) {
    if (!file_) throw FileError(name, "cannot write the file");
  }
  void write(const std::string& json) {
    const std::lock_guard lock(mutex_);
    file_ << json << std::endl;  // flushed for a reader that waits for the line
  }

 private:
  std::mutex mutex_;
  std::ofstream file_;
};

// The options that a process gets again if the window must be opened again, besides those of the scene (viewArguments()).
std::vector<std::string> windowArguments(const cli::ViewOptions& options) {
  std::vector<std::string> arguments;
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) arguments.insert(arguments.end(), {name, value});
  };
  add("--device", options.device);
  add("--present-device", options.presentDevice);
  add("--scale", options.scaleText);
  add("--theme", options.theme);
  add("--events", options.events);
  if (options.request.launchTimeout > 0) add("--timeout", fmt::format("{}", options.request.launchTimeout));
  if (options.noSettings) arguments.emplace_back("--no-settings");
  return arguments;
}

int show(const cli::ViewOptions& options) {
  ApplicationOptions application;
  application.restarted = takeRestartNote();
  application.windowArguments = windowArguments(options);
  application.engine.device = options.device;
  application.engine.log = [](LogLevel level, const std::string& text) {
    if (level == LogLevel::warning) cli::printMessage("quintet: warning: " + text);
  };
  application.presentDevice = options.presentDevice;
  application.scale = options.scale.value_or(0.0f);
  if (!options.theme.empty()) application.theme = options.theme == "light" ? Theme::light : Theme::dark;
  if (!options.windowSize.empty()) application.windowSize = cli::parseSize("--window-size", options.windowSize);
  application.storesSettings = !options.noSettings;
  if (!options.startScreen)
    application.session = job::interactive::SessionRequest{.program = options.program, .render = options.request};
  std::optional<EventFile> events;
  if (!options.events.empty()) {
    events.emplace(options.events, application.restarted.has_value());
    application.onEvent = [&events](const std::string& json) { events->write(json); };
    application.logsWidgets = true;
  }
  Application(std::move(application)).run();
  return 0;
}

}  // namespace
}  // namespace quintet::viewer

int main(int argc, char** argv) {
  using namespace quintet;
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  try {
    releaseLargeBlocksImmediately();
    gpu::prepareDriverEnvironment();  // before other threads exist
    const std::optional<cli::ViewOptions> options = cli::parseViewOptions(arguments);
    return options ? viewer::show(*options) : 0;
  } catch (const std::exception& error) {
    return cli::reportFailure(error, cli::FailureJson::none);
  }
}
