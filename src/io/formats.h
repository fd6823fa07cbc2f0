// Private to src/io: what the decoders share, and the entry points of each format.
#ifndef QUINTET_IO_FORMATS_H
#define QUINTET_IO_FORMATS_H

#include <span>
#include <string>

#include "io/codec.h"

namespace quintet::io {

// The bytes of one file, and its name for messages.
struct Source {
  std::span<const std::byte> bytes;
  const std::string& name;

  std::size_t size() const { return bytes.size(); }
  const std::uint8_t* data() const { return reinterpret_cast<const std::uint8_t*>(bytes.data()); }
  std::uint8_t operator[](std::size_t i) const { return data()[i]; }
  // True if `text` stands at `offset`.
  bool has(std::size_t offset, std::string_view text) const;

  [[noreturn]] void fail(const std::string& problem) const;
  [[noreturn]] void fail(std::size_t offset, const std::string& problem) const;
  // Fails beyond kMaxImageSide and kMaxImageBytes; to be called before memory is asked for.
  void checkSize(std::uint64_t width, std::uint64_t height, std::uint64_t bytesPerPixel) const;
  // Fails if `decoded` bytes cannot come from this file at the format's best compression.
  void checkExpansion(std::uint64_t decoded, std::uint64_t bytesPerByte) const;
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

// Throws UsageError for an image without pixels or with sizes that disagree.
void checkEncodable(const Image& image, std::string_view format);
// Throws UsageError for keywords that PNG or OpenEXR cannot hold.
void checkMetadata(const Metadata& metadata);

}  // namespace quintet::io
#endif
