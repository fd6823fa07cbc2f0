// SPDX-License-Identifier: Apache-2.0
#include "job/watch.h"

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "base/text.h"
#include "job/identity.h"

namespace quintet::job {
namespace {

namespace fs = std::filesystem;
using Files = std::vector<fs::path>;

void addMissing(Files& files, const Files& added) {
  for (const fs::path& file : added)
    if (std::ranges::find(files, file) == files.end()) files.push_back(file);
}

// Files that diagnostics name: a file from outside the program that does not compile.
Files filesOf(const std::vector<Diagnostic>& diagnostics) {
  Files files;
  std::error_code ignored;
  for (const Diagnostic& d : diagnostics)
    if (fs::is_regular_file(d.file, ignored)) files.emplace_back(d.file);
  return files;
}

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

}  // namespace

bool LiveJob::reload(Observer& observer) {
  const bool isFirst = !std::exchange(hasRun_, true);
  try {
    ResolvedJob resolved = resolve_();
    const bool sceneChanged = std::ranges::any_of(
        changed_, [&](const fs::path& file) { return std::ranges::find(sceneFiles_, file) != sceneFiles_.end(); });
    if (sceneChanged || (scene_ && scene_->source != resolved.scene)) scene_.reset();
    // Until the job exists, those of the last one stay: the cause of an error can be among them.
    addMissing(files_, programFiles(resolved));
    addMissing(files_, sourceFiles(resolved.scene));
    job_.reset();
    job_ = std::make_unique<RenderJob>(engine_, std::move(resolved), observer, scene_);
    sceneFiles_ = job_->sceneFiles();
    files_ = job_->files();
    return true;
  } catch (const ProgramError& error) {
    addMissing(files_, filesOf(error.diagnostics()));
    observer.diagnostics(error.diagnostics());
  } catch (const FileError& error) {
    if (isFirst) throw;
    observer.diagnostics({asDiagnostic(error)});
  } catch (const UsageError& error) {  // such as a value for a parameter that no longer exists
    if (isFirst) throw;
    observer.diagnostics({{Severity::error, "", 0, 0, "", error.what()}});
  }
  return false;
}

std::size_t LiveJob::watchFiles() {
  std::error_code ignored;
  Files folders;
  const fs::path program = program_;
  if (fs::is_directory(program, ignored)) folders.push_back(program);
  if (program.filename() == "program.toml") folders.push_back(program.has_parent_path() ? program.parent_path() : ".");
  Files files = files_;
  if (fs::is_regular_file(program, ignored)) files.push_back(program);
  watcher_.watch(files, folders, isProgramSource);
  return files.size();
}

Files LiveJob::waitForChange(double seconds) {
  Files changed = watcher_.wait(seconds);
  if (changed.empty()) return changed;
  changed_ = changed;
  changeAge_ = ageOf(changed);
  sinceChange_ = Stopwatch();
  return changed;
}

std::string LiveJob::changedNames() const {
  std::string names;
  for (const fs::path& file : changed_) names += (names.empty() ? "" : ", ") + file.filename().string();
  return printable(names);
}

}  // namespace quintet::job
