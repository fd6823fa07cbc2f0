// SPDX-License-Identifier: Apache-2.0
// Finds the command, runs it, and turns exceptions into an exit status and messages (cli/failure.h).
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/suggestion.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/signals.h"
#include "gpu/instance.h"

namespace quintet::cli {
namespace {

std::string helpText() {
  std::string text =
      "Quintet: five shaders in, image out. A path tracer for glTF scenes on Vulkan ray tracing.\n\n"
      "Usage: quintet COMMAND [OPTIONS]\n\nCommands:\n";
  for (const Command& command : commands()) text += fmt::format("  {:<10}{}\n", command.name, command.summary);
  return text +
         "\n  quintet COMMAND --help      options and examples of a command\n  quintet --version           version of "
         "Quintet\n\n"
         "Examples:\n"
         "  quintet render scene.glb                          scene.png, 1280x720, 64 samples per pixel\n"
         "  quintet render scene.glb -o out.exr --time 60     as many samples as possible in a minute\n"
         "  quintet run ao                                    a program on the built-in scene\n"
         "  quintet info                                      the Vulkan devices\n"
         "  quintet compare out.png reference.png             measures of their difference\n";
}

int dispatch(const std::vector<std::string>& arguments) {
  const std::string first = arguments.empty() ? "--help" : arguments.front();
  if (first == "--help" || first == "-h" || first == "help") {
    writeFile("-", helpText());
    return arguments.empty() ? 2 : 0;
  }
  if (first == "--version" || first == "version") {
    writeFile("-", "quintet " QUINTET_VERSION "\n");
    return 0;
  }
  const auto all = commands();
  const auto found = std::ranges::find(all, first, &Command::name);
  if (found != all.end()) return found->run(Arguments(arguments).subspan(1));

  std::vector<std::string> names{"--help", "--version"};
  std::ranges::transform(all, std::back_inserter(names), [](const Command& c) { return std::string(c.name); });
  throw UsageError(fmt::format("unknown {} '{}'{}; 'quintet --help' lists the commands",
                               first.starts_with('-') ? "option" : "command", first, suggestion(first, names)));
}

// The descriptor of a closed standard stream would be reused by the next file that is opened. It is replaced by one that is
// open in the wrong direction, so that using it still fails.
void occupyStandardStreams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(fd, F_GETFD) < 0) [[maybe_unused]]
      const int opened = ::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
}

// Also if the command line cannot be parsed.
bool wantsJson(const std::vector<std::string>& arguments) {
  return std::ranges::find(arguments, "--json") != arguments.end();
}

}  // namespace
}  // namespace quintet::cli

int main(int argc, char** argv) {
  using namespace quintet;
  cli::occupyStandardStreams();
  // A reader that has ended and a file that becomes too large are ordinary errors.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  cli::installSignalHandlers();
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  try {
    releaseLargeBlocksImmediately();
    gpu::prepareDriverEnvironment();  // before other threads exist
    return cli::dispatch(arguments);
  } catch (const std::exception& error) {
    return cli::reportFailure(error, cli::wantsJson(arguments));
  } catch (...) {
    return cli::reportFailure(Error("unknown error"), cli::wantsJson(arguments));
  }
}
