// SPDX-License-Identifier: Apache-2.0
// Waits for saves of the files from which a render or a check was made.
#ifndef QUINTET_JOB_SOURCE_WATCHER_H
#define QUINTET_JOB_SOURCE_WATCHER_H

#include <filesystem>
#include <string>
#include <vector>

#include "base/diagnostic.h"
#include "base/stopwatch.h"
#include "shader/file_watcher.h"

namespace quintet::job {

struct WatchList {
  std::vector<std::filesystem::path> files;
  std::vector<std::filesystem::path> folders;  // of programs: all files isProgramSource() there, also new ones
  bool anyFile = false;                        // in the folders, all files count

  void addFile(const std::filesystem::path& file);  // unless the list has it
  void addFiles(const std::vector<std::filesystem::path>& added);
  // Files that diagnostics name: a file from outside the program that does not compile.
  void addDiagnosed(const std::vector<Diagnostic>& diagnostics);
  // The folder or file to which the name of a program refers; nothing for a built-in program.
  void addProgram(const std::filesystem::path& name);
};

class SourceWatcher {
 public:
  // Replaces the list. Saves that were noticed before are kept. Throws Error if the system's limit of watches is reached.
  void watch(WatchList list);
  const WatchList& watched() const { return list_; }

  // True if a file was saved since the last wait(). Does not block.
  bool pending() { return watcher_.pending(); }
  // Waits up to `seconds` for a save; a signal ends the wait. Returns the files; empty if nothing was saved.
  std::vector<std::filesystem::path> wait(double seconds);

  // The files of the last save, their names ("a.rgen, b.rchit"), and the time since they were written, seconds.
  const std::vector<std::filesystem::path>& changed() const { return changed_; }
  std::string changedNames() const;
  double secondsSinceChange() const { return changeAge_ + sinceChange_.seconds(); }

 private:
  shader::FileWatcher watcher_;
  WatchList list_;
  std::vector<std::filesystem::path> changed_;
  double changeAge_ = 0;  // seconds between the save and its detection
  Stopwatch sinceChange_;
};

}  // namespace quintet::job
#endif
