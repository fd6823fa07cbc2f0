// SPDX-License-Identifier: Apache-2.0
// Private to src/io: the input of the decoders, and one table of functions for each format.
#ifndef QUINTET_IO_FORMATS_H
#define QUINTET_IO_FORMATS_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "io/image.h"

namespace quintet::io {

// The bytes of one file, and its name for messages.
struct Source {
  std::span<const std::byte> bytes;
  const std::string& name;

  std::size_t size() const { return bytes.size(); }
  const std::uint8_t* data() const { return reinterpret_cast<const std::uint8_t*>(bytes.data()); }
  std::uint8_t operator[](std::size_t i) const { return data()[i]; }
  // Returns whether the bytes at `offset` are `text`.
  bool has(std::size_t offset, std::string_view text) const;

  // Throws FileError "name: problem", or "name: byte 312: problem".
  [[noreturn]] void fail(const std::string& problem) const;
  [[noreturn]] void fail(std::size_t offset, const std::string& problem) const;
  // Fails for sizes above kMaxImageSide and kMaxImageBytes. Call it before memory is allocated.
  void checkSize(std::uint64_t width, std::uint64_t height, std::uint64_t bytesPerPixel) const;
  // Fails if the file is too small for `decoded` bytes at the best compression ratio of the format.
  void checkExpansion(std::uint64_t decoded, std::uint64_t bestRatio) const;
};

struct Format {
  std::string_view name;
  bool (*matches)(const Source&);
  ImageInfo (*probe)(const Source&);
  Image (*decode)(const Source&);
  Metadata (*metadata)(const Source&);  // may be null
};

extern const Format kPng;
extern const Format kJpeg;
extern const Format kWebp;
extern const Format kHdr;
extern const Format kExr;
extern const Format kKtx2;

// Throws UsageError for an image without pixels or with inconsistent sizes.
void checkEncodable(const Image& image, std::string_view format);
// Throws UsageError for keywords and texts that PNG or OpenEXR cannot store.
void checkMetadata(const Metadata& metadata);

}  // namespace quintet::io
#endif
