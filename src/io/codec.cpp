#include "io/codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <new>

#include "base/error.h"
#include "base/file.h"
#include "io/formats.h"

namespace quintet::io {
namespace {

constexpr std::array<const Format*, 5> kFormats{&kPng, &kJpeg, &kWebp, &kHdr, &kExr};
constexpr std::size_t kMaxMessage = 250;  // characters

const Format& findFormat(const Source& source) {
  for (const Format* format : kFormats)
    if (format->matches(source)) return *format;
  source.fail(source.size() == 0 ? "the image is empty"
                                 : "not an image that can be read (PNG, JPEG, WebP, Radiance HDR, OpenEXR)");
}

// Runs `read(format)`; a picture within the limits may still be larger than the memory that is left.
template <class Read>
auto withFormat(const Source& source, Read&& read) {
  try {
    return read(findFormat(source));
  } catch (const std::bad_alloc&) {
    source.fail("not enough memory for the image");
  }
}

// Problems may quote the file: no control characters to the terminal, and one line.
std::string printable(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 32 || c > 126; }, '?');
  if (text.size() > kMaxMessage) text.replace(kMaxMessage, std::string::npos, "...");
  return text;
}

std::string lowerExtension(const std::filesystem::path& file) {
  std::string text = file.extension().string();
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

bool Source::has(std::size_t offset, std::string_view text) const {
  return offset <= size() && size() - offset >= text.size() &&
         std::memcmp(bytes.data() + offset, text.data(), text.size()) == 0;
}

void Source::fail(const std::string& problem) const { throw FileError(name, printable(problem)); }
void Source::fail(std::size_t offset, const std::string& problem) const {
  throw FileError(name, fmt::format("byte {}", offset), printable(problem));
}

void Source::checkSize(std::uint64_t width, std::uint64_t height, std::uint64_t bytesPerPixel) const {
  if (width == 0 || height == 0) fail(fmt::format("the image has no pixels ({} x {})", width, height));
  if (width > kMaxImageSide || height > kMaxImageSide)
    fail(fmt::format("the image is too large: {} x {} pixels; at most {} a side can be read", width, height,
                     kMaxImageSide));
  if (width * height * bytesPerPixel > kMaxImageBytes)
    fail(fmt::format("the image is too large: {} x {} pixels need {} MiB; at most {} can be read", width, height,
                     (width * height * bytesPerPixel) >> 20, kMaxImageBytes >> 20));
}

void Source::checkExpansion(std::uint64_t decoded, std::uint64_t bytesPerByte) const {
  if (decoded / bytesPerByte > size())
    fail(size(), fmt::format("the data ends early: its header promises {} bytes of pixels", decoded));
}

Image decodeImage(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  const Source source{bytes, nameForErrors};
  return withFormat(source, [&](const Format& format) { return format.decode(source); });
}

Image readImage(const std::filesystem::path& file) { return decodeImage(readFile(file), file.string()); }

ImageInfo probeImage(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  const Source source{bytes, nameForErrors};
  return withFormat(source, [&](const Format& format) {
    ImageInfo info = format.probe(source);
    info.format = format.name;
    return info;
  });
}

Metadata readMetadata(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  const Source source{bytes, nameForErrors};
  return withFormat(source,
                    [&](const Format& format) { return format.metadata ? format.metadata(source) : Metadata{}; });
}

void checkEncodable(const Image& image, std::string_view format) {
  if (image.pixelCount() == 0) throw UsageError(fmt::format("an image without pixels cannot be written as {}", format));
  if (image.channels < 1 || image.channels > 4 || image.data.size() != image.rowBytes() * image.height)
    throw UsageError(fmt::format("the image to be written as {} has {} bytes for {} x {} pixels of {} channels", format,
                                 image.data.size(), image.width, image.height, image.channels));
}

void checkMetadata(const Metadata& metadata) {
  for (const auto& [key, text] : metadata) {
    const bool printable = std::ranges::all_of(key, [](unsigned char c) { return c >= 32 && c < 127; });
    if (key.empty() || key.size() > 79 || !printable || key.front() == ' ' || key.back() == ' ' ||
        key.find("  ") != std::string::npos)
      throw UsageError(fmt::format("'{}' cannot be a metadata keyword (1 to 79 printable ASCII characters)", key));
    if (text.find('\0') != std::string::npos)
      throw UsageError(fmt::format("the metadata text of '{}' contains a zero byte", key));
  }
}

void writeImage(const std::filesystem::path& file, const Image& image, const Metadata& metadata) {
  const std::string extension = file == "-" ? ".png" : lowerExtension(file);
  if (extension == ".png") {
    const bool ready = image.type != PixelType::f32 && !(image.premultiplied && image.hasAlpha());
    writeFile(file, encodePng(ready ? image : toSrgb8(image), metadata));
  } else if (extension == ".exr") {
    writeFile(file, encodeExr(image, metadata));
  } else if (extension == ".hdr") {
    writeFile(file, encodeHdr(image));
  } else {
    throw UsageError(file.string() + ": images are written as .png, .exr or .hdr");
  }
}

}  // namespace quintet::io
