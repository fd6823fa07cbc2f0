// SPDX-License-Identifier: Apache-2.0
// Reports changes of files on disk, with inotify. It watches folders rather than files: editors write a new file and
// rename it over the old one, and a missing file can appear later.
#ifndef QUINTET_SHADER_FILE_WATCHER_H
#define QUINTET_SHADER_FILE_WATCHER_H

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <vector>

struct inotify_event;

namespace quintet::shader {

class FileWatcher {
 public:
  FileWatcher();  // throws Error if the system has no inotify instance left
  ~FileWatcher();
  FileWatcher(const FileWatcher&) = delete;
  FileWatcher& operator=(const FileWatcher&) = delete;

  // Selects the files of a folder to watch, by name. They need not exist.
  using Filter = std::function<bool(const std::filesystem::path& name)>;

  // Sets the files to watch, and the folders whose files to watch if `filter` selects them. Changes recorded before
  // this call are kept. Files need not exist. A symbolic link is watched together with its target. Throws Error if
  // the system's limit of watches is reached.
  void watch(const std::vector<std::filesystem::path>& files, const std::vector<std::filesystem::path>& folders = {},
             Filter filter = {});

  // True if there is a change that wait() has not returned yet. Does not block.
  bool pending();

  // Blocks until a watched file is written, replaced or removed, the time has elapsed, or a signal arrives; after a
  // change, until no more changes follow (an editor saves in several steps). Returns the changed paths, sorted and
  // unique: files as given to watch(), or a folder as given with the file's name. Empty if nothing changed.
  std::vector<std::filesystem::path> wait(double seconds);

 private:
  void read();  // moves pending events to changed_
  void handle(const inotify_event& event);
  void recordChange(const std::filesystem::path& path);
  void addFolders(bool recordFiles);  // starts to watch the folders that exist now
  bool poll(int milliseconds);        // true if events are pending
  void settle();                      // waits until no more changes follow

  int inotify_ = -1;
  std::map<std::filesystem::path, std::set<std::filesystem::path>> files_;     // absolute path -> paths as given
  std::map<std::filesystem::path, std::set<std::filesystem::path>> filtered_;  // absolute folder -> folders as given
  Filter filter_;
  std::map<std::filesystem::path, int> folders_;  // folder -> watch; -1 if it does not exist yet
  std::set<std::filesystem::path> changed_;       // paths as given
};

}  // namespace quintet::shader
#endif
