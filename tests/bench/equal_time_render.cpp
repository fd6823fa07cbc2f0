// SPDX-License-Identifier: Apache-2.0
#include "equal_time_render.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"

extern char** environ;

namespace quintet::bench {
namespace {

double secondsOf(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

// Runs `command` with standard output to a file. Returns its processor time in seconds.
double runToFile(std::vector<std::string>& command, const std::filesystem::path& out) {
  std::vector<char*> arguments;
  for (std::string& text : command) arguments.push_back(text.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  pid_t process = -1;
  const int code = ::posix_spawn(&process, command[0].c_str(), &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (code != 0) throw Error(fmt::format("{}: cannot be started", command[0]));
  int status = 0;
  rusage usage{};
  while (::wait4(process, &status, 0, &usage) < 0)
    if (errno != EINTR) throw Error("wait4 failed");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw Error(fmt::format("failed: {}", fmt::join(command, " ")));
  return secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime);
}

}  // namespace

std::vector<BenchScene> readScenes(const std::filesystem::path& list, const std::filesystem::path& folder) {
  std::istringstream lines(readTextFile(list));
  std::vector<BenchScene> scenes;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    BenchScene scene;
    std::string file;
    if (line.starts_with('#') || !(words >> scene.name >> file)) continue;
    scene.file = folder / file;
    for (std::string word; words >> word;) {
      const bool isFile = std::filesystem::is_regular_file(folder / word);
      scene.options.push_back(isFile ? (folder / word).string() : word);
    }
    scenes.push_back(std::move(scene));
  }
  if (scenes.empty()) throw FileError(list, "no scenes in the list");
  return scenes;
}

RenderCost render(const RenderCall& call) {
  std::vector<std::string> command{call.binary.string(),
                                   "render",
                                   call.scene->file.string(),
                                   "-o",
                                   call.output.string(),
                                   "--size",
                                   call.size,
                                   "--seed",
                                   std::to_string(call.seed),
                                   "--json",
                                   "--quiet"};
  if (call.samples > 0) command.insert(command.end(), {"--spp", std::to_string(call.samples)});
  if (call.seconds > 0) command.insert(command.end(), {"--time", fmt::format("{}", call.seconds)});
  command.insert(command.end(), call.scene->options.begin(), call.scene->options.end());
  command.insert(command.end(), call.more.begin(), call.more.end());
  const std::filesystem::path report = call.output.string() + ".json";
  RenderCost cost;
  cost.cpuSeconds = runToFile(command, report);
  const auto json = nlohmann::json::parse(readTextFile(report));
  std::filesystem::remove(report);
  cost.samples = json.at("samples").get<std::uint64_t>();
  cost.deviceSeconds = json.at("seconds").at("device").get<double>();
  cost.device = fmt::format("{}, {}", json.at("device").get<std::string>(), json.at("driver").get<std::string>());
  return cost;
}

}  // namespace quintet::bench
