// SPDX-License-Identifier: Apache-2.0
#include "restart.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace quintet::viewer {
namespace {

using nlohmann::json;

constexpr const char* kVariable = "QUINTET_VIEW_RESTART";  // the number of the descriptor with the note

std::string noteJson(const RestartNote& note) {
  json diagnostics = json::array();
  for (const Diagnostic& d : note.diagnostics)
    diagnostics.push_back({{"severity", static_cast<int>(d.severity)},
                           {"file", d.file},
                           {"line", d.line},
                           {"column", d.column},
                           {"id", d.id},
                           {"text", d.text}});
  json object{{"script", note.script}, {"error", note.error}, {"diagnostics", std::move(diagnostics)}};
  if (note.position) object["position"] = {note.position->x, note.position->y};
  return object.dump(-1, ' ', false, json::error_handler_t::replace);
}

RestartNote parseNote(const std::string& text) {
  const json object = json::parse(text);
  RestartNote note;
  object.at("script").get_to(note.script);
  object.at("error").get_to(note.error);
  for (const json& d : object.at("diagnostics"))
    note.diagnostics.push_back({static_cast<Severity>(d.at("severity").get<int>()), d.at("file").get<std::string>(),
                                d.at("line").get<int>(), d.at("column").get<int>(), d.at("id").get<std::string>(),
                                d.at("text").get<std::string>()});
  if (object.contains("position")) note.position = glm::ivec2(object["position"][0], object["position"][1]);
  return note;
}

bool writeAll(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t count = ::write(file, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

std::string readAll(int file) {
  std::string text;
  char buffer[4096];
  for (ssize_t count = 0; (count = ::pread(file, buffer, sizeof buffer, static_cast<off_t>(text.size()))) > 0;)
    text.append(buffer, static_cast<std::size_t>(count));
  return text;
}

// All files but the standard ones and the note, so that the new process does not inherit those of the driver.
void closeFilesOnExec(int note) {
  const int most = static_cast<int>(::sysconf(_SC_OPEN_MAX));
  constexpr int kSurelyEnough = 65536;
  for (int file = 3; file < std::min(most, kSurelyEnough); ++file)
    if (file != note) ::fcntl(file, F_SETFD, FD_CLOEXEC);
}

}  // namespace

std::string restartProcess(const std::vector<std::string>& arguments, const RestartNote& note) {
  const int file = ::memfd_create("quintet-view", 0);
  if (file < 0 || !writeAll(file, noteJson(note)))
    return fmt::format("the window cannot be opened again: {}", std::strerror(errno));
  ::setenv(kVariable, std::to_string(file).c_str(), 1);
  std::vector<char*> pointers;
  std::string name = "quintet-view";
  std::vector<std::string> texts = arguments;
  pointers.push_back(name.data());
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  closeFilesOnExec(file);
  ::execv("/proc/self/exe", pointers.data());
  const std::string error = fmt::format("the window cannot be opened again: {}", std::strerror(errno));
  ::unsetenv(kVariable);
  ::close(file);
  return error;
}

std::optional<RestartNote> takeRestartNote() {
  const char* value = std::getenv(kVariable);
  if (!value) return std::nullopt;
  const int file = std::atoi(value);
  ::unsetenv(kVariable);
  const std::string text = readAll(file);
  ::close(file);
  try {
    return parseNote(text);
  } catch (const json::exception&) {  // set by something else
    return std::nullopt;
  }
}

}  // namespace quintet::viewer
