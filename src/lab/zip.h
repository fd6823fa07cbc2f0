// SPDX-License-Identifier: Apache-2.0
// Zip files in memory, for programs that are exported and imported: PKWARE's APPNOTE 6.3 without encryption, ZIP64 and
// several disks. Reading checks everything that a file states before it allocates.
#ifndef QUINTET_LAB_ZIP_H
#define QUINTET_LAB_ZIP_H

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace quintet::lab {

inline constexpr std::size_t kMaxUnzippedBytes = std::size_t{64} << 20;
inline constexpr std::size_t kMaxZipEntries = 1000;

// Names and contents. The result is the same for the same files.
std::string zipFiles(const std::map<std::string, std::string>& files);

// Names and contents, without folders. Names are as the archive states them: the caller checks them. Throws FileError for
// a broken archive, for features that are not supported, and above the limits.
std::map<std::string, std::string> unzipFiles(std::string_view archive);

}  // namespace quintet::lab
#endif
