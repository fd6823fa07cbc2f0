// SPDX-License-Identifier: Apache-2.0
// How fast the lab answers a page: from the connection to the first image, from a saved edit to its image, and images per
// second while the camera moves.
//   quintet_lab_rate PROGRAM...    built-in programs, as in quintet_lab_rate ao lessons/05_shadow
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/file.h"
#include "base/stopwatch.h"
#include "lab/project_folder.h"
#include "page_client.h"
#include "temp_folder.h"

namespace quintet::test {
namespace {

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// Moves the camera as often as a display of 60 Hz does, for `seconds`.
double dragRate(PageClient& page, double seconds) {
  const Stopwatch clock;
  std::size_t images = 0, moves = 0;
  while (clock.seconds() < seconds) {
    for (; static_cast<double>(moves) < clock.seconds() * 60; ++moves) page.send({{"do", "orbit"}, {"dx", 0.5}});
    page.waitForImage();
    ++images;
  }
  return static_cast<double>(images) / clock.seconds();
}

// Adds a statement to the main function that changes the code, but not the image: no compiler knows that no invocation has
// this index.
std::string edited(const std::string& text, int edit) {
  const std::size_t begin = text.find("void main()");
  const std::size_t body = begin == text.npos ? text.npos : text.find('{', begin);
  if (body == text.npos) throw std::runtime_error("the shader has no main function");
  std::string changed = text;
  return changed.insert(body + 1, fmt::format(" if (gl_LaunchIDEXT.x == {}u) return; ", 1000000 + edit));
}

void measure(const std::string& program) {
  const TempFolder folder;
  const LabProcess server(folder.path(), {"--size", "640x360"});
  const std::string name = "<programs/" + program + ">", copy = "copy";
  server.request("POST", "/api/programs", Json{{"from", name}, {"to", copy}}.dump());
  const Json files = server.request("GET", "/api/program?name=" + copy).json();
  std::string file = files.at("main");
  for (const Json& entry : files.at("files"))
    if (entry.at("role") == "raygen") file = entry.at("path");

  std::vector<double> first, edits;
  std::optional<PageClient> page;
  for (int i = 0; i < 5; ++i) {
    const Stopwatch clock;
    page.emplace(server);
    page->send({{"do", "open"}, {"program", copy}});
    page->waitForImage();
    first.push_back(clock.seconds());
  }
  const std::string text = readTextFile(folder / file);
  // No cache of a driver has the code of an earlier run.
  const auto run =
      static_cast<int>(std::chrono::system_clock::now().time_since_epoch() / std::chrono::seconds(1) % 100000000);
  for (int i = 0; i < 5; ++i) {
    const std::string next = edited(text, run + i);
    const Stopwatch clock;
    server.request("PUT", "/api/files/" + file, next, {{"if-match", "*"}});
    page->waitFor("reloaded");
    page->waitForImage();
    edits.push_back(clock.seconds());
  }
  fmt::print(
      "{} at 640x360: first image {:.2f} s (median of 5, {:.2f} to {:.2f}); edit to image {:.2f} s ({:.2f} to "
      "{:.2f}); ",
      program, median(first), std::ranges::min(first), std::ranges::max(first), median(edits), std::ranges::min(edits),
      std::ranges::max(edits));
  page->waitForImage();
  fmt::print("while the camera moves {:.1f} images/s\n", dragRate(*page, 5));
}

}  // namespace
}  // namespace quintet::test

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> programs(argv + std::min(argc, 1), argv + argc);
    if (programs.empty()) throw std::runtime_error("usage: quintet_lab_rate PROGRAM...");
    for (const std::string& program : programs) quintet::test::measure(program);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "quintet_lab_rate: {}\n", error.what());
    return 1;
  }
}
