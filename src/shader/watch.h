// Tells when files on disk change, with inotify. Whole folders are watched, not files: editors write a new file and
// rename it over the old one, and a file that is missing now may come.
#ifndef QUINTET_SHADER_WATCH_H
#define QUINTET_SHADER_WATCH_H

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <vector>

struct inotify_event;

namespace quintet::shader {

class FileWatcher {
 public:
  FileWatcher();  // throws Error if the system grants no inotify instance
  ~FileWatcher();
  FileWatcher(const FileWatcher&) = delete;
  FileWatcher& operator=(const FileWatcher&) = delete;

  // Which of a folder's files matter, those that do not exist yet among them.
  using Filter = std::function<bool(const std::filesystem::path& name)>;

  // What matters from now on; what has changed before this call stays noted. Files need not exist; a symbolic link
  // is watched together with what it points to. Of the folders, the files for which `filter` says so. Throws Error if
  // the system's limit of watches is reached.
  void watch(const std::vector<std::filesystem::path>& files, const std::vector<std::filesystem::path>& folders = {},
             Filter filter = {});

  // Something was saved, but wait() has not told yet. Does not block.
  bool pending();

  // Blocks until one of the files was written, replaced or removed, or the time is over, or a signal came; then
  // until nothing more happens for a moment (an editor takes several steps). Returns the files as they were given
  // to watch(), or the folder as it was given and the name, sorted, each once; empty: nothing happened.
  std::vector<std::filesystem::path> wait(double seconds);

 private:
  void read();  // moves the system's events to changed_
  void handle(const inotify_event& event);
  void note(const std::filesystem::path& place);
  void addFolders(bool tell);   // watches those that exist by now
  bool poll(int milliseconds);  // events are there
  void settle();                // until nothing more happens

  int inotify_ = -1;
  std::map<std::filesystem::path, std::set<std::filesystem::path>> places_;    // absolute place -> names as given
  std::map<std::filesystem::path, std::set<std::filesystem::path>> filtered_;  // absolute folder -> names as given
  Filter filter_;
  std::map<std::filesystem::path, int> folders_;  // folder -> watch; -1: not there yet
  std::set<std::filesystem::path> changed_;       // names as given
};

}  // namespace quintet::shader
#endif
