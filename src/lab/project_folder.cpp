// SPDX-License-Identifier: Apache-2.0
#include "lab/project_folder.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file.h"
#include "base/file_roots.h"
#include "base/hash.h"
#include "base/text.h"

namespace quintet::lab {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxName = 1024, kMaxPart = 255;  // bytes
constexpr int kMaxDepth = 8;                            // of listed folders

bool isInside(const fs::path& path, const fs::path& folder) {
  const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end();
}

// Links to hidden files lead as far as links to files outside: nowhere.
bool isVisible(const fs::path& path, const fs::path& folder) {
  return path == folder || (isInside(path, folder) && isFileName(path.lexically_relative(folder).generic_string()));
}

double secondsSince1970(fs::file_time_type time) {
  const auto system = std::chrono::file_clock::to_sys(time).time_since_epoch();
  return std::chrono::duration<double>(system).count();
}

}  // namespace

bool isFileName(std::string_view name) {
  if (name.empty() || name.size() > kMaxName || name.find('\\') != name.npos || printable(name) != name) return false;
  while (true) {
    const std::string_view part = name.substr(0, name.find('/'));
    if (part.empty() || part.front() == '.' || part.size() > kMaxPart) return false;
    if (part.size() == name.size()) return true;
    name.remove_prefix(part.size() + 1);
  }
}

std::string contentHash(std::string_view content) { return Hasher().add(content).finish().hex(); }

ProjectFolder::ProjectFolder(const fs::path& folder, const std::vector<std::string>& files)
    : files_(files.begin(), files.end()) {
  std::error_code error;
  root_ = fs::canonical(folder, error);
  if (error) throw FileError(folder, error.message());
  if (!fs::is_directory(root_)) throw FileError(folder, "is not a folder");
}

void ProjectFolder::addRoots() {
  hasRoots_ = true;
  if (hasAllFiles()) addFileRoot(root_);
  for (const std::string& name : files_) addFileRoot(fs::weakly_canonical(root_ / name));
}

bool ProjectFolder::hasHomeFolder() const {
  const char* home = std::getenv("HOME");
  std::error_code error;
  return home && *home && isInside(fs::weakly_canonical(home, error), root_);
}

std::string ProjectFolder::description() const {
  if (hasAllFiles()) return fmt::format("project folder: {}", root_.string());
  return fmt::format("project folder: {}, of which only {} accessible: {}", root_.string(),
                     files_.size() == 1 ? "this file is" : fmt::format("these {} files are", files_.size()),
                     fmt::join(files_, ", "));
}

fs::path ProjectFolder::locate(const std::string& name) const {
  if (!isFileName(name)) throw NameError(fmt::format("'{}' is not a name of a file in the project", printable(name)));
  std::error_code error;
  fs::path path = root_ / name;
  const fs::path resolved = fs::weakly_canonical(path, error);
  if (error) throw FileError(name, error.message());
  // What a link names that does not exist could be created there.
  const bool broken = fs::is_symlink(fs::symlink_status(path, error)) && !fs::exists(path, error);
  if (!isVisible(resolved, root_) || broken)
    throw NameError(fmt::format("'{}' leads out of the project", printable(name)));
  if (fs::exists(path, error) && !belongs(name))
    throw NameError(
        fmt::format("'{}' exists, but does not belong to the project, which is a file and what it names; to use all "
                    "files of the folder, start the lab with the folder",
                    printable(name)));
  return path;
}

// A folder belongs to the project if one of its files does.
bool ProjectFolder::belongs(const std::string& name) const {
  if (hasAllFiles() || files_.contains(name)) return true;
  const auto below = files_.lower_bound(name + "/");
  return below != files_.end() && below->starts_with(name + "/");
}

std::optional<std::string> ProjectFolder::nameOf(const fs::path& path) const {
  std::error_code error;
  const fs::path resolved = fs::weakly_canonical(path, error);
  if (error || !isInside(resolved, root_)) return {};
  const std::string name = resolved.lexically_relative(root_).generic_string();
  return isFileName(name) ? std::optional(name) : std::nullopt;
}

ProjectFolder::Listing ProjectFolder::list() const {
  Listing listing;
  std::error_code error;
  fs::recursive_directory_iterator at(root_, fs::directory_options::skip_permission_denied, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error)) {
    std::error_code ignored;
    const fs::path relative = at->path().lexically_relative(root_);
    const std::string name = relative.generic_string();
    const bool isFolder = at->is_directory(ignored);
    if (!isFileName(name) || at.depth() >= kMaxDepth) {
      if (isFolder) at.disable_recursion_pending();
      if (isFileName(name) && belongs(name)) listing.truncated = true;
      continue;
    }
    if (isFolder || !at->is_regular_file(ignored) || !belongs(name)) continue;
    if (at->is_symlink(ignored) && !isVisible(fs::weakly_canonical(at->path(), ignored), root_)) continue;
    if (listing.files.size() == kMaxListedFiles) {
      listing.truncated = true;
      break;
    }
    listing.files.push_back({name, at->file_size(ignored), secondsSince1970(at->last_write_time(ignored))});
  }
  std::ranges::sort(listing.files, {}, &Entry::name);
  return listing;
}

std::string ProjectFolder::read(const std::string& name) const {
  const fs::path path = locate(name);
  if (!fs::is_regular_file(path)) throw FileError(name, "does not exist");  // reading a pipe would wait
  return readTextFile(path);
}

std::optional<std::string> ProjectFolder::find(const fs::path& path) const {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return {};
  return readTextFile(path);
}

void ProjectFolder::require(const std::string& name, const std::optional<std::string>& content,
                            const Condition& condition) const {
  const std::string hash = content ? contentHash(*content) : "";
  if (condition.mustNotExist && content) throw ConflictError(fmt::format("{}: exists already", name), hash);
  if (condition.hash && *condition.hash != hash)
    throw ConflictError(fmt::format("{}: {}", name, content ? "was changed since it was read" : "does not exist"),
                        hash);
}

ProjectFolder::Written ProjectFolder::write(const std::string& name, std::string_view content,
                                            const Condition& condition) const {
  const fs::path path = locate(name);
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) throw FileError(name, "is not a file");
  const std::optional<std::string> before = find(path);
  require(name, before, condition);
  if (before != content) {  // an equal file would only restart the render
    fs::create_directories(path.parent_path(), error);
    if (error) throw FileError(name, "cannot create the folder: " + error.message());
    writeFile(path, content);
    if (!hasAllFiles() && files_.insert(name).second && hasRoots_) addFileRoot(path);
  }
  return {contentHash(content), !before};
}

void ProjectFolder::remove(const std::string& name, const Condition& condition) const {
  const fs::path path = locate(name);
  const std::optional<std::string> before = find(path);
  if (!before) throw FileError(name, "does not exist");
  require(name, before, condition);
  std::error_code error;
  if (!fs::remove(path, error)) throw FileError(name, "cannot remove it: " + error.message());
}

}  // namespace quintet::lab
