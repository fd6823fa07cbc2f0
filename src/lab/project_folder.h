// SPDX-License-Identifier: Apache-2.0
// The files that a page can read and write: those of one folder, or some of them. Names are relative paths without tricks, and
// symbolic links are followed only if they stay in the folder. Writing names the version that it replaces, so that nothing that
// an editor or a second page has saved is lost.
#ifndef QUINTET_LAB_PROJECT_FOLDER_H
#define QUINTET_LAB_PROJECT_FOLDER_H

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.h"

namespace quintet::lab {

inline constexpr std::size_t kMaxListedFiles = 2000;

// Returns whether a text is the name of a file: parts separated by '/', none empty or with a '.' at its begin, without
// backslashes and control characters, valid UTF-8, at most 1024 bytes.
bool isFileName(std::string_view name);

// The content of a file as 32 hexadecimal digits.
std::string contentHash(std::string_view content);

// A name that is not valid, or that leads out of the folder.
class NameError : public UsageError {
 public:
  using UsageError::UsageError;
};

// The file is not the version that the caller wants to replace.
class ConflictError : public Error {
 public:
  ConflictError(const std::string& message, std::string hash) : Error(message), hash_(std::move(hash)) {}
  const std::string& hash() const { return hash_; }  // of the file as it is; empty if it does not exist

 private:
  std::string hash_;
};

class ProjectFolder {
 public:
  // `files`: names of the files that belong to the project; empty means all of the folder. Files that are written later belong
  // to it, too. Throws FileError if the folder does not exist.
  explicit ProjectFolder(const std::filesystem::path& folder, const std::vector<std::string>& files = {});

  const std::filesystem::path& root() const { return root_; }  // absolute, without symbolic links

  // Limits what programs and scenes can read, in this process and its children, to the files of the project (base/file_roots.h).
  // write() adds its files. Not while other threads read the environment.
  void addRoots();
  bool hasHomeFolder() const;
  std::string description() const;  // one line: where it is, and what belongs to it

  bool hasAllFiles() const { return files_.empty(); }
  const std::set<std::string>& files() const { return files_; }  // that belong to it; empty means all

  // The path of a file or folder that need not exist. Throws NameError; also for a file that exists and does not belong to
  // the project.
  std::filesystem::path locate(const std::string& name) const;
  // The name of a path in the folder, else nothing.
  std::optional<std::string> nameOf(const std::filesystem::path& path) const;

  struct Entry {
    std::string name;
    std::uint64_t size = 0;  // bytes
    double modified = 0;     // seconds since 1970
  };
  struct Listing {
    std::vector<Entry> files;  // sorted by name, at most kMaxListedFiles
    bool truncated = false;    // the project has more files, or deeper folders
  };
  Listing list() const;

  // The versions that a caller accepts. Nothing accepts all of them.
  struct Condition {
    bool mustNotExist = false;
    std::optional<std::string> hash;
  };
  struct Written {
    std::string hash;
    bool created = false;
  };
  // All throw NameError, FileError, and those with a condition ConflictError.
  std::string read(const std::string& name) const;
  Written write(const std::string& name, std::string_view content, const Condition& condition) const;
  void remove(const std::string& name, const Condition& condition) const;

 private:
  std::optional<std::string> find(const std::filesystem::path& path) const;
  void require(const std::string& name, const std::optional<std::string>& content, const Condition& condition) const;
  bool belongs(const std::string& name) const;

  std::filesystem::path root_;
  mutable std::set<std::string> files_;  // grows with what is written
  bool hasRoots_ = false;
};

}  // namespace quintet::lab
#endif
