// SPDX-License-Identifier: Apache-2.0
#include "lab/file_message.h"

#include "lab/little_endian.h"

namespace quintet::lab {
namespace {

constexpr std::string_view kFileMagic = "QFIL";
constexpr std::uint64_t kFileVersion = 1;

}  // namespace

std::string fileMessage(const FilePart& part) {
  std::string message(kFileMagic);
  message.reserve(kFileHeaderBytes + part.bytes.size());
  appendInteger(message, kFileVersion, 4);
  appendInteger(message, part.file, 4);
  message.append(4, '\0');
  appendInteger(message, part.offset, 8);
  message.append(kFileHeaderBytes - message.size(), '\0');
  return message.append(part.bytes);
}

std::optional<FilePart> parseFileMessage(std::string_view message) {
  if (message.size() < kFileHeaderBytes || !message.starts_with(kFileMagic) || integerAt(message, 4, 4) != kFileVersion)
    return {};
  return FilePart{.file = static_cast<std::uint32_t>(integerAt(message, 8, 4)),
                  .offset = integerAt(message, 16, 8),
                  .bytes = message.substr(kFileHeaderBytes)};
}

}  // namespace quintet::lab
