// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <span>
#include <string_view>

#include <fmt/format.h>

#include "io/terminal_image.h"

namespace quintet::io {
namespace {

constexpr std::size_t kChunkBytes = 3072;  // 4096 digits

// A multiple of 3 bytes, which needs no padding.
std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve(bytes.size() / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::uint32_t bits = static_cast<std::uint32_t>(bytes[i] << 16 | bytes[i + 1] << 8 | bytes[i + 2]);
    for (int shift = 18; shift >= 0; shift -= 6) text += kDigits[bits >> shift & 63];
  }
  return text;
}

}  // namespace

std::string encodeKitty(const Image& image, std::uint32_t id) {
  assert(image.channels == 3 && id != 0);
  const std::span<const std::uint8_t> bytes = image.samples<std::uint8_t>();
  std::string text;
  text.reserve(bytes.size() / 3 * 4 + bytes.size() / kChunkBytes * 16 + 128);
  for (std::size_t i = 0; i < bytes.size(); i += kChunkBytes) {
    const std::size_t count = std::min(bytes.size() - i, kChunkBytes);
    text += "\x1b_G";
    // Transmit and display; quiet; RGB; placement 1; keep the cursor.
    if (i == 0) text += fmt::format("a=T,q=2,f=24,s={},v={},i={},p=1,C=1,", image.width, image.height, id);
    text += fmt::format("m={};", i + count < bytes.size() ? 1 : 0);
    text += base64(bytes.subspan(i, count));
    text += "\x1b\\";
  }
  return text;
}

std::string deleteKitty(std::uint32_t id) { return fmt::format("\x1b_Ga=d,d=I,i={},q=2\x1b\\", id); }

}  // namespace quintet::io
