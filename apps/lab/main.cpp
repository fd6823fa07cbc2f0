// SPDX-License-Identifier: Apache-2.0
// `quintet-lab`: the server of the lab, and its workers. `quintet lab` starts it with its arguments.
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "cli/command.h"
#include "cli/console.h"
#include "cli/failure.h"
#include "cli/lab_options.h"
#include "gpu/driver_environment.h"
#include "lab/private_folder.h"
#include "lab/sandbox.h"
#include "lab/server.h"
#include "lab/start_target.h"
#include "lab/worker.h"
#include "lab/worker_process.h"

extern char** environ;  // NOLINT: POSIX

namespace quintet::cli {

// The help texts of the library list the commands of the program; this one has none besides `lab`.
std::span<const Command> commands() { return {}; }

}  // namespace quintet::cli

namespace quintet::lab {

std::span<const EmbeddedFile> embeddedPage();

namespace {

namespace fs = std::filesystem;

// Only where a browser can have a window. Without one, the printed URL is enough.
void openBrowser(const std::string& url) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  // The shell ends at once, so that the browser is not a child of the server.
  std::string shell = "sh", option = "-c", script = "xdg-open \"$1\" >/dev/null 2>&1 &", address = url;
  std::array<char*, 6> arguments{shell.data(), option.data(), script.data(), shell.data(), address.data(), nullptr};
  pid_t process = 0;
  if (::posix_spawnp(&process, shell.c_str(), nullptr, nullptr, arguments.data(), environ) == 0)
    ::waitpid(process, nullptr, 0);
}

Server makeServer(const ProjectFolder& project, ServerOptions options, const cli::LabOptions& request) {
  options.port = request.port.value_or(cli::kLabPort);
  try {
    return Server(project, options);
  } catch (const UsageError&) {
    throw;
  } catch (const Error&) {
    if (request.port) throw;
    options.port = 0;
    return Server(project, options);
  }
}

int serve(const cli::LabOptions& request) {
  const StartTarget target = chooseStart(request.target);
  std::error_code error;
  fs::create_directories(target.folder, error);
  if (error) throw FileError(target.folder, "cannot create the folder: " + error.message());
  ProjectFolder project(target.folder, target.files);
  project.addRoots();  // of the workers, too
  removeAbandonedFolders();
  ServerOptions options;
  options.address = request.bind;
  options.device = request.device;
  options.idleSeconds = request.idle;
  options.contained = !request.noSandbox;
  options.memory = request.maxMemory ? request.maxMemory : machineMemory() / 2;
  options.memoryHint = cli::optionHint(Remedy::raiseMemoryLimit);
  options.worker = fs::read_symlink("/proc/self/exe");
  options.page = embeddedPage();
  options.defaults = {.program = target.program,
                      .scene = target.scene,
                      .size = request.size,
                      .samples = request.samples,
                      .timeout = request.timeout,
                      .maxSessions = request.sessions};
  Server server = makeServer(project, std::move(options), request);
  writeFile("-", server.url() + "\n");
  cli::printMessage(fmt::format("{}; press Ctrl-C to stop", printable(project.description())));
  const std::string home = project.hasHomeFolder()
                               ? "the project contains your home folder: a shader that takes over the "
                                 "process of its page can read all your files; use a folder of its own"
                               : "";
  const std::string gaps =
      request.noSandbox ? "shaders are not contained (--no-sandbox)" : sandboxGaps(sandboxSupport());
  for (const std::string& warning : {server.exposure(), gaps, home})
    if (!warning.empty()) cli::printMessage("warning: " + warning);
  if (!request.noOpen) openBrowser(server.urlForBrowser());
  server.run();
  return 0;
}

}  // namespace
}  // namespace quintet::lab

int main(int argc, char** argv) {
  using namespace quintet;
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  const std::vector<std::string> arguments(argv + std::min(argc, 1), argv + argc);
  try {
    releaseLargeBlocksImmediately();
    gpu::prepareDriverEnvironment();  // before other threads exist
    if (arguments.size() == 1 && arguments.front() == lab::kWorkerOption) return lab::runWorker(lab::kWorkerSocket);
    const std::optional<cli::LabOptions> options = cli::parseLabOptions(arguments);
    return options ? lab::serve(*options) : 0;
  } catch (const lab::SandboxError& error) {
    return cli::reportFailure(error, cli::FailureJson::none, "; --no-sandbox starts the lab without the restriction");
  } catch (const std::exception& error) {
    return cli::reportFailure(error, cli::FailureJson::none);
  }
}
