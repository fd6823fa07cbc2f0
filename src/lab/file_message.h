// SPDX-License-Identifier: Apache-2.0
// The binary message with a part of a file that the page downloads: a header of 32 bytes and the bytes
// (docs/design/lab-protocol.md, "Files to download"). The page asks for one part after the other, so that a slow connection
// does not fill the memory of the server.
#ifndef QUINTET_LAB_FILE_MESSAGE_H
#define QUINTET_LAB_FILE_MESSAGE_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace quintet::lab {

inline constexpr std::size_t kFileHeaderBytes = 32;
inline constexpr std::size_t kFilePartBytes = std::size_t{4} << 20;  // of a part, at most

struct FilePart {
  std::uint32_t file = 0;  // number
  std::uint64_t offset = 0;
  std::string_view bytes;
};

std::string fileMessage(const FilePart& part);
// `bytes` refers to the message. Nothing if the message is shorter than a header, or begins differently.
std::optional<FilePart> parseFileMessage(std::string_view message);

}  // namespace quintet::lab
#endif
