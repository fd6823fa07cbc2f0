// SPDX-License-Identifier: Apache-2.0
// The binary message of an image: a header of 32 bytes and a JPEG or PNG file (docs/design/lab-protocol.md, "Images").
#ifndef QUINTET_LAB_IMAGE_MESSAGE_H
#define QUINTET_LAB_IMAGE_MESSAGE_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/math.h"

namespace quintet::lab {

enum class ImageFormat : std::uint8_t { jpeg = 1, png = 2 };

inline constexpr std::size_t kImageHeaderBytes = 32;

struct ImageHeader {
  std::uint32_t number = 0;   // from 1
  uvec2 size{0};              // pixels
  std::uint32_t factor = 1;   // by which its sides are smaller than those of the session
  std::uint32_t samples = 0;  // per pixel, or frames
  ImageFormat format = ImageFormat::png;
  bool complete = false;
  bool operator==(const ImageHeader&) const = default;
};

std::string imageMessage(const ImageHeader& header, std::span<const std::byte> file);
// Nothing if the message is shorter than a header, or begins differently.
std::optional<ImageHeader> parseImageHeader(std::string_view message);

}  // namespace quintet::lab
#endif
