// SPDX-License-Identifier: Apache-2.0
#include "shader/file_watcher.h"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.h"

namespace quintet::shader {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kEvents =
    IN_CLOSE_WRITE | IN_MOVED_TO | IN_MOVED_FROM | IN_CREATE | IN_DELETE | IN_DELETE_SELF | IN_MOVE_SELF | IN_ONLYDIR;
constexpr int kSettleMilliseconds = 15;    // between the steps of an editor that saves
constexpr int kReplaceMilliseconds = 150;  // a removed file can reappear within this time
constexpr int kFolderMilliseconds = 250;   // interval at which missing folders are checked

[[noreturn]] void fail(const std::string& what) {
  throw Error("cannot watch files: " + what + ": " + std::generic_category().message(errno));
}

fs::path absoluteFile(const fs::path& file) {
  std::error_code ignored;
  const fs::path absolute = fs::absolute(file, ignored).lexically_normal();
  // Links are resolved for the folder only: a rename replaces a link to a file, not its target.
  const fs::path folder = fs::weakly_canonical(absolute.parent_path(), ignored);
  return ignored ? absolute : folder / absolute.filename();
}

// Returns the target of a symbolic link; empty for any other file.
fs::path target(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_symlink(file, ignored)) return {};
  const fs::path real = fs::weakly_canonical(file, ignored);
  return ignored ? fs::path() : real;
}

}  // namespace

FileWatcher::FileWatcher() : inotify_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (inotify_ < 0) fail("inotify");
}

FileWatcher::~FileWatcher() { ::close(inotify_); }

void FileWatcher::watch(const std::vector<fs::path>& files, const std::vector<fs::path>& folders, Filter filter) {
  read();
  files_.clear();
  filtered_.clear();
  filter_ = std::move(filter);
  std::set<fs::path> wanted;
  const auto add = [&](const fs::path& path, const fs::path& given) {
    files_[path].insert(given);
    wanted.insert(path.parent_path());
  };
  for (const fs::path& file : files) {
    add(absoluteFile(file), file);
    if (const fs::path real = target(file); !real.empty()) add(real, file);
  }
  for (const fs::path& folder : folders) {
    std::error_code ignored;
    const fs::path absolute = fs::weakly_canonical(fs::absolute(folder, ignored), ignored);
    filtered_[absolute].insert(folder);
    wanted.insert(absolute);
  }
  for (auto at = folders_.begin(); at != folders_.end();) {
    if (wanted.contains(at->first)) {
      ++at;
      continue;
    }
    if (at->second >= 0) ::inotify_rm_watch(inotify_, at->second);
    at = folders_.erase(at);
  }
  for (const fs::path& folder : wanted) folders_.try_emplace(folder, -1);
  addFolders(false);
}

// `recordFiles`: a folder that appears later can already contain watched files.
void FileWatcher::addFolders(bool recordFiles) {
  for (auto& [folder, watch] : folders_) {
    if (watch >= 0) continue;
    watch = ::inotify_add_watch(inotify_, folder.c_str(), kEvents);
    if (watch < 0 && errno == ENOSPC) fail(folder.string());
    if (watch < 0 || !recordFiles) continue;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) recordChange(entry.path());
  }
}

void FileWatcher::recordChange(const fs::path& path) {
  const auto found = files_.find(path);
  if (found != files_.end()) changed_.insert(found->second.begin(), found->second.end());
  const auto folder = filtered_.find(path.parent_path());
  if (folder == filtered_.end() || !filter_ || !filter_(path.filename())) return;
  for (const fs::path& given : folder->second) changed_.insert(given / path.filename());
}

void FileWatcher::handle(const inotify_event& event) {
  if (event.mask & IN_Q_OVERFLOW) {
    for (const auto& [path, given] : files_) recordChange(path);
    return;
  }
  const auto folder = std::ranges::find(folders_, event.wd, [](const auto& entry) { return entry.second; });
  if (folder == folders_.end()) return;
  if (event.mask & (IN_DELETE_SELF | IN_MOVE_SELF | IN_IGNORED)) {
    if (event.mask & IN_MOVE_SELF) ::inotify_rm_watch(inotify_, event.wd);
    folder->second = -1;
    return;
  }
  if (event.len == 0) return;
  const fs::path path = folder->first / event.name;
  // A new file counts once it is written and closed, a new link immediately.
  if (std::error_code ignored; (event.mask & IN_CREATE) && !fs::is_symlink(path, ignored)) return;
  recordChange(path);
}

void FileWatcher::read() {
  alignas(inotify_event) std::array<char, 16384> buffer;
  while (true) {
    const ssize_t got = ::read(inotify_, buffer.data(), buffer.size());
    if (got <= 0) return;
    for (std::size_t at = 0; at < static_cast<std::size_t>(got);) {
      const auto& event = *reinterpret_cast<const inotify_event*>(buffer.data() + at);  // aligned by the kernel
      handle(event);
      at += sizeof event + event.len;
    }
  }
}

bool FileWatcher::poll(int milliseconds) {
  pollfd waiting{inotify_, POLLIN, 0};
  return ::poll(&waiting, 1, milliseconds) > 0;
}

bool FileWatcher::pending() {
  read();
  return !changed_.empty();
}

std::vector<fs::path> FileWatcher::wait(double seconds) {
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  while (!pending()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0) return {};
    const bool missing = std::ranges::any_of(folders_, [](const auto& entry) { return entry.second < 0; });
    const auto longest = static_cast<long>(missing ? kFolderMilliseconds : 1000 * 60);
    errno = 0;
    if (!poll(static_cast<int>(std::min<long>(left, longest))) && errno == EINTR) return {};
    if (missing) addFolders(true);
  }
  settle();
  std::vector<fs::path> result(changed_.begin(), changed_.end());
  changed_.clear();
  return result;
}

void FileWatcher::settle() {
  const auto complete = [this] {
    return std::ranges::all_of(changed_, [](const fs::path& file) {
      std::error_code ignored;
      return fs::exists(file, ignored);
    });
  };
  for (int waited = 0; waited < 40 * kSettleMilliseconds; waited += kSettleMilliseconds) {
    if (poll(kSettleMilliseconds)) {
      read();
    } else if (waited >= kReplaceMilliseconds || complete()) {
      return;
    }
  }
}

}  // namespace quintet::shader
