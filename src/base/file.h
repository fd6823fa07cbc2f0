// Reading whole files, writing them so that a reader never sees half of one, and the folders where
// the platform wants caches.
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

// std::allocator, but resize() leaves new elements of simple types uninitialised.
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

// Throws FileError (missing, a folder, unreadable, larger than memory).
std::vector<std::byte> readFile(const std::filesystem::path& file);
// The same for large files: not cleared first, and read on all cores. (Mapping the file would be no faster, and a file
// that another program cuts short would kill this one.)
FileBytes readLargeFile(const std::filesystem::path& file);
std::string readTextFile(const std::filesystem::path& file);

// Writes to a temporary file beside `file` (temporary_file.h), flushes it to the disk and renames it over `file`.
// On failure (no folder, no permission, disk full) the temporary is removed, what was there stays,
// and a FileError is thrown. "-" means standard output. Devices and pipes are written directly.
void writeFile(const std::filesystem::path& file, std::span<const std::byte> data);
void writeFile(const std::filesystem::path& file, std::string_view text);

// Removes the temporary files of processes that were killed while they wrote `file`; writeFile does so, too. Throws as
// checkWritable does.
void removeLeftovers(const std::filesystem::path& file);

// Throws the FileError that writeFile would give for a path that cannot be written at all
// (missing folder, a folder itself, no permission), without touching an existing file: lets a
// long job fail before it starts.
void checkWritable(const std::filesystem::path& file);

// $XDG_CACHE_HOME/quintet or ~/.cache/quintet; $QUINTET_CACHE_DIR overrides both. Not created here.
// Empty when no home is known: then caches are off.
std::filesystem::path cacheFolder();

// The folder of the running executable; empty if the system does not tell.
std::filesystem::path executableFolder();

}  // namespace quintet
#endif
