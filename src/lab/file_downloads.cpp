// SPDX-License-Identifier: Apache-2.0
#include "lab/file_downloads.h"

#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "base/error.h"
#include "lab/file_message.h"
#include "lab/session_events.h"

namespace quintet::lab {

namespace fs = std::filesystem;

std::string FileDownloads::offer(const fs::path& file, const std::string& name, const std::string& type) {
  std::error_code error;
  const fs::path kept = folder_ / fmt::format("file{}{}", ++number_, file.extension().string());
  fs::rename(file, kept, error);
  if (error) throw FileError(file, error.message());
  if (!file_.empty()) fs::remove(file_, error);
  file_ = kept;
  const std::uintmax_t size = fs::file_size(file_, error);
  if (error) throw FileError(file_, error.message());
  return fileJson(number_, name, type, size);
}

std::string FileDownloads::part(std::uint32_t number, std::uint64_t offset) const {
  if (number == 0 || number != number_) throw UsageError(fmt::format("there is no file {}", number));
  std::ifstream stream(file_, std::ios::binary);
  std::string bytes(kFilePartBytes, '\0');
  if (!stream.seekg(static_cast<std::streamoff>(offset))) throw FileError(file_, "cannot be read");
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (stream.bad()) throw FileError(file_, "cannot be read");
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return fileMessage({.file = number, .offset = offset, .bytes = bytes});
}

}  // namespace quintet::lab
