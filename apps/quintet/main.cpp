// SPDX-License-Identifier: Apache-2.0
// Finds the command, runs it, and turns exceptions into an exit status and messages (cli/failure.h).
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/typographic.h"
#include "cli/command.h"
#include "cli/failure.h"
#include "cli/signals.h"
#include "cli/supervisor.h"
#include "commands/help.h"
#include "gpu/driver_environment.h"
#include "job/version.h"

namespace quintet::cli {
namespace {

int dispatch(const std::vector<std::string>& arguments) {
  const std::string first = arguments.empty() ? "--help" : arguments.front();
  if (first == "--help" || first == "-h") {
    writeFile("-", overviewText());
    return arguments.empty() ? kWrongCommandLine : 0;
  }
  if (first == "--version" || first == "version") {
    writeFile("-", std::string("quintet ") + job::quintetVersion() + "\n");
    return 0;
  }
  if (const NamedCommand found = commandNamed(arguments); found.command)
    return found.command->run(Arguments(arguments).subspan(found.words));
  if (commandWords(first).empty()) throw UsageError(unknownCommandText(first));
  const std::string second = arguments.size() > 1 ? arguments[1] : "";
  if (second == "--help" || second == "-h") {
    writeFile("-", groupText(first));
    return 0;
  }
  throw UsageError(unknownCommandText(first, second));
}

bool isIsolated(const std::vector<std::string>& arguments) {
  const NamedCommand found = commandNamed(arguments);
  return found.command && found.command->isolated;
}

// The descriptor of a closed standard stream would be reused by the next file that is opened. It is replaced by one that is
// open in the wrong direction, so that using it still fails.
void occupyStandardStreams() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(fd, F_GETFD) < 0) [[maybe_unused]]
      const int opened = ::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
}

// Commands that were copied from a text may contain typographic quotes. Returns the end of an error message.
std::string quoteHint(const std::vector<std::string>& arguments) {
  const auto quoted = std::ranges::find_if(
      arguments, [](const std::string& argument) { return !findTypographicQuote(argument).empty(); });
  return quoted == arguments.end() ? "" : "; " + typographicQuoteHint(findTypographicQuote(*quoted));
}

}  // namespace
}  // namespace quintet::cli

int main(int argc, char** argv) {
  using namespace quintet;
  cli::occupyStandardStreams();
  // A reader that has ended and a file that becomes too large are ordinary errors.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  if (cli::isIsolated(arguments))
    if (const std::optional<int> status = cli::supervise(arguments)) return *status;
  cli::installSignalHandlers();
  try {
    releaseLargeBlocksImmediately();
    gpu::prepareDriverEnvironment();  // before other threads exist
    return cli::dispatch(arguments);
  } catch (const std::exception& error) {
    return cli::reportFailure(error, cli::failureJson(arguments), cli::quoteHint(arguments));
  } catch (...) {
    return cli::reportFailure(Error("unknown error"), cli::failureJson(arguments));
  }
}
