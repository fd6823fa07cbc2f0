// Finds the command, and turns whatever goes wrong in it into one line and an exit status: 2 for a command
// that makes no sense, 1 for everything that the world refuses.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <iterator>
#include <new>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "commands.h"
#include "gpu/driver_environment.h"
#include "signals.h"
#include "standard_error.h"
#include "values.h"

namespace quintet::app {
namespace {

std::string helpText() {
  std::string text =
      "Quintet: five shaders in, image out. A path tracer for glTF scenes on Vulkan ray tracing.\n\n"
      "Usage: quintet COMMAND [OPTIONS]\n\nCommands:\n";
  for (const Command& command : commands()) text += fmt::format("  {:<10}{}\n", command.name, command.summary);
  return text +
         "\n  quintet COMMAND --help says more, with examples; quintet --version says which one this is.\n\n"
         "Examples:\n"
         "  quintet render scene.glb                          scene.png, 1280x720, 64 samples per pixel\n"
         "  quintet render scene.glb -o out.exr --time 60     as many samples as a minute allows\n"
         "  quintet run ao                                    a program on the built-in scene\n"
         "  quintet info                                      which devices there are\n"
         "  quintet compare out.png reference.png             how far they are apart\n";
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

// A closed standard stream would be taken by the next file that is opened. In its place comes one that can
// only be opened the wrong way round, so that using it still fails.
void occupyStandardStreams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(fd, F_GETFD) < 0) [[maybe_unused]]
      const int opened = ::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
}

// One line, whatever the message holds.
int fail(std::string message, int status) {
  std::ranges::replace(message, '\n', ' ');
  printError("quintet: {}\n", plain(message));
  return status;
}

}  // namespace
}  // namespace quintet::app

int main(int argc, char** argv) {
  using namespace quintet;
  app::occupyStandardStreams();
  // A reader that goes away and a file that becomes too large are errors like others.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  app::installSignalHandlers();
  try {
    returnLargeBlocksAtOnce();
    gpu::prepareDriverEnvironment();  // before there are other threads
    return app::dispatch({argv + std::min(argc, 1), argv + argc});
  } catch (const UsageError& error) {
    return app::fail(error.what(), 2);
  } catch (const std::bad_alloc&) {
    return app::fail("out of memory", 1);
  } catch (const std::exception& error) {
    return app::fail(error.what(), 1);
  } catch (...) {
    return app::fail("unknown failure", 1);
  }
}
