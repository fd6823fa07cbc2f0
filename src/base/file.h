// SPDX-License-Identifier: Apache-2.0
// Reads whole files, replaces files atomically, and finds the folders of the cache and of the executable.
#ifndef QUINTET_BASE_FILE_H
#define QUINTET_BASE_FILE_H

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace quintet {

class MemoryBudget;

// std::allocator, except that resize() leaves new elements of trivial types uninitialized.
template <class T>
struct UnclearedAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = UnclearedAllocator<U>;
  };
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }
};
using FileBytes = std::vector<std::byte, UnclearedAllocator<std::byte>>;

// The name of standard input for the functions that read, and of standard output for those that write.
inline constexpr const char* kStandardInput = "-";

// Reads a whole file, or all of a pipe: what was read from standard input, a pipe or a socket is kept, and reading it again
// gives the same bytes. Throws FileError if it is missing, a folder, or unreadable; MemoryError if it is larger than 80 % of
// the machine's memory, or than the budget allows. A budget counts the bytes before they are allocated.
std::vector<std::byte> readFile(const std::filesystem::path& file);
std::vector<std::byte> readFile(const std::filesystem::path& file, MemoryBudget&);
std::string readTextFile(const std::filesystem::path& file);
std::string readTextFile(const std::filesystem::path& file, MemoryBudget&);
// Reads a large file on all cores into memory that is not cleared first. Mapping the file would not be faster, and the
// process would be killed if another process truncated the file.
FileBytes readLargeFile(const std::filesystem::path& file, MemoryBudget&);

// Writes a temporary file beside `file` (temporary_file.h), flushes it to the disk and renames it to `file`, so readers
// never see a partial file. On failure (no folder, no permission, disk full) the temporary file is removed, an existing
// `file` stays unchanged, and a FileError is thrown. "-" means standard output. Devices and pipes are written directly.
void writeFile(const std::filesystem::path& file, std::span<const std::byte> data);
void writeFile(const std::filesystem::path& file, std::string_view text);

// Removes the temporary files of processes that were killed while they wrote `file`. writeFile does this as well.
// Throws the errors of checkWritable.
void removeLeftovers(const std::filesystem::path& file);

// Throws the FileError of writeFile for a path that cannot be written (missing folder, a folder itself, no permission, a
// file system that takes no files; a closed standard output for "-") without touching an existing file, so that a long
// job can fail before it starts. Creates and removes a temporary file in the folder.
void checkWritable(const std::filesystem::path& file);

// Returns $QUINTET_CACHE_DIR, $XDG_CACHE_HOME/quintet or ~/.cache/quintet, the first that is set. The folder may not
// exist. Empty if no home folder is known, which disables the caches.
std::filesystem::path cacheFolder();

// Returns the folder of the running executable; empty if it is unknown.
std::filesystem::path executableFolder();

}  // namespace quintet
#endif
