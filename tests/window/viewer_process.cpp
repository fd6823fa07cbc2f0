// SPDX-License-Identifier: Apache-2.0
#include "viewer_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace quintet::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kLimit{120};
constexpr std::chrono::milliseconds kPause{20};

}  // namespace

ViewerProcess::ViewerProcess(const XServer& server, const std::filesystem::path& folder,
                             const std::vector<std::string>& arguments,
                             const std::vector<std::pair<std::string, std::string>>& environment)
    : display_(server.display()), events_(folder / "events.jsonl"), errors_(folder / "errors.txt") {
  std::filesystem::remove(events_);
  std::vector<std::string> all{QUINTET_VIEW_BINARY, "--events", events_.string()};
  all.insert(all.end(), arguments.begin(), arguments.end());
  process_ = ::fork();
  if (process_ == 0) {
    ::setenv("DISPLAY", server.display().c_str(), 1);
    ::setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
    // The validation layer leaks memory of its own (version 1.3.239), which the sanitizer would report. Builds without
    // sanitizers validate.
    if (!QUINTET_SANITIZED) ::setenv("QUINTET_VALIDATE", "1", 1);
    ::setenv("LP_NUM_THREADS", "4", 1);
    ::unsetenv("WAYLAND_DISPLAY");
    for (const auto& [name, value] : environment) ::setenv(name.c_str(), value.c_str(), 1);
    const int errors = ::open(errors_.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0644);
    ::dup2(errors, STDERR_FILENO);
    if (::chdir(folder.c_str()) != 0) ::_exit(127);
    std::vector<char*> pointers;
    for (std::string& argument : all) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    ::execv(pointers[0], pointers.data());
    ::_exit(127);
  }
  try {
    window_ = std::make_unique<XWindow>(server.display(), [this] { return running(); });
  } catch (const std::exception& error) {
    ::kill(process_, SIGKILL);
    throw std::runtime_error(std::string(error.what()) + ": " + readErrors());
  }
}

void ViewerProcess::findWindowAgain() {
  window_ = std::make_unique<XWindow>(display_, [this] { return running(); });
}

ViewerProcess::~ViewerProcess() {
  window_.reset();
  if (!running()) return;
  ::kill(process_, SIGKILL);
  ::waitpid(process_, nullptr, 0);
}

bool ViewerProcess::running() {
  if (status_ >= 0) return false;
  int status = 0;
  if (::waitpid(process_, &status, WNOHANG) == 0) return true;
  status_ = WIFSIGNALED(status) ? 1000 + WTERMSIG(status) : WEXITSTATUS(status);
  return false;
}

std::string ViewerProcess::readErrors() const {
  std::ifstream file(errors_);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

void ViewerProcess::readEvents() {
  std::ifstream file(events_);
  file.seekg(static_cast<std::streamoff>(position_));
  for (std::string line; std::getline(file, line);) {
    if (file.eof()) break;  // the line is not complete
    position_ += line.size() + 1;
    Json event = Json::parse(line);
    if (event["event"] == "controls")
      controls_ = std::move(event);
    else
      received_.push_back(std::move(event));
  }
}

Json ViewerProcess::waitFor(const std::function<bool(const Json&)>& matches) {
  const Clock::time_point end = Clock::now() + kLimit;
  for (;;) {
    readEvents();
    while (next_ < received_.size())
      if (const Json& event = received_[next_++]; matches(event)) return event;
    if (Clock::now() > end || !running()) {
      std::string last = "no event";
      if (!received_.empty()) last = received_.back().dump();
      throw std::runtime_error("the event does not arrive; the last is " + last + "\n" + readErrors());
    }
    std::this_thread::sleep_for(kPause);
  }
}

Json ViewerProcess::waitFor(const std::string& name) {
  return waitFor([&](const Json& event) { return event["event"] == name; });
}

Json ViewerProcess::waitForImage() {
  return waitFor([](const Json& event) { return event["event"] == "image" && event["complete"] == true; });
}

void ViewerProcess::settle() {
  constexpr std::chrono::milliseconds kQuiet{500};
  Clock::time_point last = Clock::now();
  std::size_t seen = position_;
  while (Clock::now() - last < kQuiet) {
    readEvents();
    if (position_ != seen) last = Clock::now();
    seen = position_;
    std::this_thread::sleep_for(kPause);
  }
}

bool ViewerProcess::hasControl(const std::string& name) {
  readEvents();
  if (!controls_.contains("controls")) return false;
  for (const Json& item : controls_["controls"])
    if (item["name"] == name) return true;
  return false;
}

std::array<int, 4> ViewerProcess::control(const std::string& name) {
  const Clock::time_point end = Clock::now() + kLimit;
  while (!hasControl(name)) {
    if (Clock::now() > end || !running()) throw std::runtime_error("no control " + name + " in " + controls_.dump());
    std::this_thread::sleep_for(kPause);
  }
  std::array<int, 4> result{};
  for (const Json& item : controls_["controls"])
    if (item["name"] == name)
      for (std::size_t i = 0; i < 4; ++i) result[i] = static_cast<int>(std::lround(item["rect"][i].get<double>()));
  return result;
}

std::array<int, 4> ViewerProcess::imageArea() {
  const Clock::time_point end = Clock::now() + kLimit;
  for (readEvents(); !controls_.contains("image") && Clock::now() < end; readEvents())
    std::this_thread::sleep_for(kPause);
  std::array<int, 4> result{};
  for (std::size_t i = 0; i < 4; ++i) result[i] = static_cast<int>(std::lround(controls_["image"][i].get<double>()));
  return result;
}

void ViewerProcess::clickControl(const std::string& name) {
  const auto [left, top, right, bottom] = control(name);
  window_->click((left + right) / 2, (top + bottom) / 2);
}

ViewerProcess::End ViewerProcess::finish() {
  const Clock::time_point end = Clock::now() + kLimit;
  while (running() && Clock::now() < end) std::this_thread::sleep_for(kPause);
  return {running() ? -1 : status_, readErrors()};
}

}  // namespace quintet::test
