// SPDX-License-Identifier: Apache-2.0
// Finds the command, runs it, and turns exceptions into one line on standard error and an exit status: 2 for a wrong command
// line, 1 for every other failure.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/typographic.h"
#include "cli/command.h"
#include "cli/console.h"
#include "cli/signals.h"
#include "commands/help.h"
#include "gpu/instance.h"

namespace quintet::cli {
namespace {

int dispatch(const std::vector<std::string>& arguments) {
  const std::string first = arguments.empty() ? "--help" : arguments.front();
  if (first == "--help" || first == "-h") {
    writeFile("-", overviewText());
    return arguments.empty() ? 2 : 0;
  }
  if (first == "--version" || first == "version") {
    writeFile("-", "quintet " QUINTET_VERSION "\n");
    return 0;
  }
  const auto all = commands();
  const auto found = std::ranges::find(all, first, &Command::name);
  if (found != all.end()) return found->run(Arguments(arguments).subspan(1));

  throw UsageError(unknownCommandText(first));
}

// The descriptor of a closed standard stream would be reused by the next file that is opened. It is replaced by one that is
// open in the wrong direction, so that using it still fails.
void occupyStandardStreams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(fd, F_GETFD) < 0) [[maybe_unused]]
      const int opened = ::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
}

// The message on one line. Commands that were copied from a text may contain typographic quotes.
int fail(std::string message, int status, const std::vector<std::string>& arguments = {}) {
  std::ranges::replace(message, '\n', ' ');
  const auto quoted = std::ranges::find_if(
      arguments, [](const std::string& argument) { return !findTypographicQuote(argument).empty(); });
  if (quoted != arguments.end()) message += "; " + typographicQuoteHint(findTypographicQuote(*quoted));
  printMessage("quintet: " + printable(message));
  return status;
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
  } catch (const UsageError& error) {
    return cli::fail(error.what(), 2, arguments);
  } catch (const std::bad_alloc&) {
    return cli::fail("out of memory", 1);
  } catch (const std::exception& error) {
    return cli::fail(error.what(), 1, arguments);
  } catch (...) {
    return cli::fail("unknown error", 1);
  }
}
