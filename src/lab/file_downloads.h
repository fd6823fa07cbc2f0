// SPDX-License-Identifier: Apache-2.0
// The files that a worker has made for its page, which reads them part by part. A new file replaces the one before, so that a
// page that never reads them does not fill the disk.
#ifndef QUINTET_LAB_FILE_DOWNLOADS_H
#define QUINTET_LAB_FILE_DOWNLOADS_H

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>

namespace quintet::lab {

class FileDownloads {
 public:
  // `folder`: private, exists.
  explicit FileDownloads(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Where to write the next file.
  std::filesystem::path pathFor(const std::string& extension) const { return folder_ / ("download." + extension); }
  // Offers the file that was written there, and removes the one before. Returns the event that describes it. Throws
  // FileError.
  std::string offer(const std::filesystem::path& file, const std::string& name, const std::string& type);
  // The binary message with the part of the file `number` at `offset`; without bytes at its end. Throws UsageError for
  // other numbers, FileError.
  std::string part(std::uint32_t number, std::uint64_t offset) const;

 private:
  const std::filesystem::path folder_;
  std::filesystem::path file_;
  std::uint32_t number_ = 0;  // of file_; 0: none
};

}  // namespace quintet::lab
#endif
