// SPDX-License-Identifier: Apache-2.0
#include "io/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "base/plural.h"
#include "base/text.h"

namespace quintet::io {
namespace {

constexpr std::size_t kMaxMessageBytes = 250;

// Problems can quote the file: the text must be printable and short.
std::string message(const std::string& problem) {
  return printable(problem.substr(0, kMaxMessageBytes)) + (problem.size() > kMaxMessageBytes ? "..." : "");
}

}  // namespace

bool Source::has(std::size_t offset, std::string_view text) const {
  return offset <= size() && size() - offset >= text.size() &&
         std::memcmp(bytes.data() + offset, text.data(), text.size()) == 0;
}

void Source::fail(const std::string& problem) const { throw FileError(name, message(problem)); }
void Source::fail(std::size_t offset, const std::string& problem) const {
  throw FileError(name, fmt::format("byte {}", offset), message(problem));
}

void Source::checkSize(std::uint64_t width, std::uint64_t height, std::uint64_t bytesPerPixel) const {
  if (width == 0 || height == 0) fail(fmt::format("the image has no pixels ({} x {})", width, height));
  if (width > kMaxImageSide || height > kMaxImageSide)
    fail(fmt::format("the image is too large: {} x {} pixels; at most {} per side are supported", width, height,
                     kMaxImageSide));
  if (width * height * bytesPerPixel > kMaxImageBytes)
    fail(fmt::format("the image is too large: {} x {} pixels need {} MiB; at most {} MiB are supported", width, height,
                     (width * height * bytesPerPixel) >> 20, kMaxImageBytes >> 20));
}

void Source::checkExpansion(std::uint64_t decoded, std::uint64_t bestRatio) const {
  if (decoded / bestRatio > size())
    fail(size(), fmt::format("the data ends early: its header declares {} bytes of pixels", decoded));
}

void checkEncodable(const Image& image, std::string_view format) {
  if (image.pixelCount() == 0) throw UsageError(fmt::format("an image without pixels cannot be written as {}", format));
  if (image.channels < 1 || image.channels > 4 || image.data.size() != image.rowBytes() * image.height)
    throw UsageError(fmt::format("the image to be written as {} has {} for {} x {} pixels of {}", format,
                                 counted(image.data.size(), "byte"), image.width, image.height,
                                 counted(image.channels, "channel")));
}

void checkMetadata(const Metadata& metadata) {
  for (const auto& [key, text] : metadata) {
    const bool ascii = std::ranges::all_of(key, [](unsigned char c) { return c >= 32 && c < 127; });
    if (key.empty() || key.size() > 79 || !ascii || key.front() == ' ' || key.back() == ' ' ||
        key.find("  ") != std::string::npos)
      throw UsageError(fmt::format("'{}' cannot be a metadata keyword (1 to 79 printable ASCII characters)", key));
    if (text.find('\0') != std::string::npos)
      throw UsageError(fmt::format("the metadata text of '{}' contains a zero byte", key));
  }
}

}  // namespace quintet::io
