// SPDX-License-Identifier: Apache-2.0
#include "job/source_watcher.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "base/text.h"
#include "job/resolve.h"

namespace quintet::job {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

// Seconds since the latest of the files was written; 0 if they are gone or their times are implausible.
double ageOf(const Files& files) {
  constexpr double kPlausible = 600;
  double age = kPlausible;
  for (const fs::path& file : files) {
    std::error_code failed;
    const auto time = fs::last_write_time(file, failed);
    const double seconds = std::chrono::duration<double>(fs::file_time_type::clock::now() - time).count();
    if (!failed && seconds >= 0) age = std::min(age, seconds);
  }
  return age < kPlausible ? age : 0;
}

void addMissing(Files& files, const fs::path& file) {
  if (std::ranges::find(files, file) == files.end()) files.push_back(file);
}

}  // namespace

void WatchList::addFile(const fs::path& file) { addMissing(files, file); }

void WatchList::addFiles(const Files& added) {
  for (const fs::path& file : added) addFile(file);
}

void WatchList::addDiagnosed(const std::vector<Diagnostic>& diagnostics) {
  std::error_code ignored;
  for (const Diagnostic& d : diagnostics)
    if (fs::is_regular_file(d.file, ignored)) addFile(d.file);
}

void WatchList::addProgram(const fs::path& name) {
  std::error_code ignored;
  if (fs::is_directory(name, ignored)) addMissing(folders, name);
  if (fs::is_regular_file(name, ignored)) addFile(name);
  if (name.filename() == "program.toml") addMissing(folders, name.has_parent_path() ? name.parent_path() : ".");
}

void SourceWatcher::watch(WatchList list) {
  list_ = std::move(list);
  const auto all = [](const fs::path& file) { return !file.filename().string().starts_with('.'); };  // temporary files
  watcher_.watch(list_.files, list_.folders, list_.anyFile ? shader::FileWatcher::Filter(all) : isProgramSource);
}

Files SourceWatcher::wait(double seconds) {
  Files changed = watcher_.wait(seconds);
  if (changed.empty()) return changed;
  changed_ = changed;
  changeAge_ = ageOf(changed);
  sinceChange_ = Stopwatch();
  return changed;
}

std::string SourceWatcher::changedNames() const {
  std::string names;
  for (const fs::path& file : changed_) names += (names.empty() ? "" : ", ") + file.filename().string();
  return printable(names);
}

}  // namespace quintet::job
