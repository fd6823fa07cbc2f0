// SPDX-License-Identifier: Apache-2.0
#include "lab/image_message.h"

#include "lab/little_endian.h"

namespace quintet::lab {
namespace {

constexpr std::string_view kMagic = "QIMG";
constexpr std::uint32_t kVersion = 1;

std::uint32_t number(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint32_t>(integerAt(bytes, at, 4));
}

}  // namespace

std::string imageMessage(const ImageHeader& header, std::span<const std::byte> file) {
  std::string bytes(kMagic);
  bytes.reserve(kImageHeaderBytes + file.size());
  for (const std::uint32_t value :
       {kVersion, header.number, header.size.x, header.size.y, header.factor, header.samples})
    appendInteger(bytes, value, 4);
  bytes += static_cast<char>(header.format);
  bytes += static_cast<char>(header.complete ? 1 : 0);
  bytes.append(2, '\0');
  bytes.append(reinterpret_cast<const char*>(file.data()), file.size());
  return bytes;
}

std::optional<ImageHeader> parseImageHeader(std::string_view message) {
  if (message.size() < kImageHeaderBytes || !message.starts_with(kMagic) || number(message, 4) != kVersion) return {};
  const char format = message[28];
  if (format != 1 && format != 2) return {};
  return ImageHeader{.number = number(message, 8),
                     .size = {number(message, 12), number(message, 16)},
                     .factor = number(message, 20),
                     .samples = number(message, 24),
                     .format = static_cast<ImageFormat>(format),
                     .complete = message[29] == 1};
}

}  // namespace quintet::lab
