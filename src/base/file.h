// Reading whole files, writing them so that a reader never sees half of one, and the folders where
// the platform wants caches.
#ifndef QUINTET_BASE_FILE_H
#define QUINTET_BASE_FILE_H

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quintet {

// Throws FileError (missing, a folder, unreadable, larger than memory).
std::vector<std::byte> readFile(const std::filesystem::path& file);
std::string readTextFile(const std::filesystem::path& file);

// Writes to a temporary file beside `file`, flushes it to the disk and renames it over `file`.
// On failure (no folder, no permission, disk full) the temporary is removed, what was there stays,
// and a FileError is thrown. "-" means standard output. Devices and pipes are written directly.
void writeFile(const std::filesystem::path& file, std::span<const std::byte> data);
void writeFile(const std::filesystem::path& file, std::string_view text);

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
