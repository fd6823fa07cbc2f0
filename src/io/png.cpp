// SPDX-License-Identifier: Apache-2.0
// PNG through libspng, with an own read callback so that errors contain the offset.
#include <fmt/format.h>
#include <spng.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "base/error.h"
#include "io/codec.h"
#include "io/formats.h"

namespace quintet::io {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
// Best case of DEFLATE: a match of 258 bytes takes two bits (RFC 1951, 3.2.5).
constexpr std::uint64_t kBestDeflate = 1032;
// Limit for profiles and text, which can inflate to any size.
constexpr std::size_t kMaxChunkBytes = std::size_t{64} << 20;

// zlib's level. Its default, 6, takes twice as long and saves 1 % (noisy images).
constexpr int kCompression = 4;

struct FreeContext {
  void operator()(spng_ctx* ctx) const { spng_ctx_free(ctx); }
};
using Context = std::unique_ptr<spng_ctx, FreeContext>;

Context makeContext(int flags) {
  Context ctx(spng_ctx_new(flags));
  if (!ctx) throw std::bad_alloc();
  return ctx;
}

class Reader {
 public:
  explicit Reader(const Source& source) : source_(source), ctx_(makeContext(0)) {
    check(spng_set_crc_action(ctx_.get(), SPNG_CRC_ERROR, SPNG_CRC_ERROR));
    check(spng_set_chunk_limits(ctx_.get(), kMaxChunkBytes, kMaxChunkBytes));
    check(spng_set_png_stream(ctx_.get(), &Reader::read, this));
    check(spng_get_ihdr(ctx_.get(), &header_));
    source_.checkSize(header_.width, header_.height, channelsInFile() * (header_.bit_depth == 16 ? 2u : 1u));
  }

  const spng_ihdr& header() const { return header_; }
  spng_ctx* ctx() const { return ctx_.get(); }

  void check(int error) const {
    if (error == SPNG_OK) return;
    if (error == SPNG_EMEM) throw std::bad_alloc();
    if (error == SPNG_IO_EOF || error == SPNG_EOF || error == SPNG_IO_ERROR)
      source_.fail(source_.size(), "PNG data ends early");
    if (error == SPNG_ECHUNK_CRC) source_.fail(offset_, "PNG chunk with a wrong checksum");
    source_.fail(offset_, fmt::format("broken PNG: {}", spng_strerror(error)));
  }

  // Reads to the end of the file, which detects a missing tail. libspng accepts a truncated last checksum; this does
  // not.
  void finish() const {
    check(spng_decode_chunks(ctx_.get()));
    if (ended_) check(SPNG_IO_EOF);
  }

  // Returns whether a tRNS chunk adds transparency to an image without an alpha channel.
  bool transparent() const {
    spng_trns ignored;
    const int error = spng_get_trns(ctx_.get(), &ignored);
    if (error != SPNG_ECHUNKAVAIL) check(error);
    return error == SPNG_OK;
  }

  std::uint32_t channelsInFile() const {
    switch (header_.color_type) {
      case SPNG_COLOR_TYPE_TRUECOLOR: return 3;
      case SPNG_COLOR_TYPE_GRAYSCALE_ALPHA: return 2;
      case SPNG_COLOR_TYPE_TRUECOLOR_ALPHA: return 4;
      default: return 1;
    }
  }
  std::uint32_t channels() const {
    if (header_.color_type == SPNG_COLOR_TYPE_INDEXED) return transparent() ? 4 : 3;
    const std::uint32_t stored = channelsInFile();
    return stored % 2 == 1 && transparent() ? stored + 1 : stored;
  }

 private:
  static int read(spng_ctx*, void* user, void* to, std::size_t length) {
    Reader& self = *static_cast<Reader*>(user);
    self.ended_ |= length > self.source_.size() - self.offset_;
    if (self.ended_) return SPNG_IO_EOF;
    std::memcpy(to, self.source_.data() + self.offset_, length);
    self.offset_ += length;
    return SPNG_OK;
  }

  const Source& source_;
  std::size_t offset_ = 0;
  bool ended_ = false;  // a read went beyond the end of the data
  spng_ihdr header_{};
  Context ctx_;
};

// Returns the libspng format for `channels` samples; SPNG_FMT_PNG if the file already has them.
int decodingFormat(const Reader& reader, std::uint32_t channels) {
  const bool wide = reader.header().bit_depth == 16;
  if (reader.header().color_type == SPNG_COLOR_TYPE_INDEXED) return channels == 4 ? SPNG_FMT_RGBA8 : SPNG_FMT_RGB8;
  if (channels == reader.channelsInFile()) return reader.header().bit_depth < 8 ? SPNG_FMT_G8 : SPNG_FMT_PNG;
  if (channels == 2) return wide ? SPNG_FMT_GA16 : SPNG_FMT_GA8;
  return wide ? SPNG_FMT_RGBA16 : SPNG_FMT_RGBA8;
}

bool matches(const Source& source) { return source.has(0, kSignature); }

ImageInfo probe(const Source& source) {
  const Reader reader(source);
  const PixelType type = reader.header().bit_depth == 16 ? PixelType::u16 : PixelType::u8;
  return {reader.header().width, reader.header().height, reader.channels(), type, {}};
}

Image decode(const Source& source) {
  const Reader reader(source);
  const spng_ihdr& header = reader.header();
  const std::uint64_t rowBits = std::uint64_t{header.width} * reader.channelsInFile() * header.bit_depth;
  source.checkExpansion(rowBits / 8 * header.height, kBestDeflate);

  const std::uint32_t channels = reader.channels();
  const PixelType type = header.bit_depth == 16 ? PixelType::u16 : PixelType::u8;
  source.checkSize(header.width, header.height, channels * bytesPerSample(type));
  Image image = makeImage(header.width, header.height, channels, type, ColorEncoding::sRgb);
  reader.check(spng_decode_image(reader.ctx(), image.data.data(), image.data.size(), decodingFormat(reader, channels),
                                 SPNG_DECODE_TRNS));
  reader.finish();
  return image;
}

Metadata metadata(const Source& source) {
  const Reader reader(source);
  std::uint32_t count = 0;
  const int error = spng_get_text(reader.ctx(), nullptr, &count);
  if (error == SPNG_ECHUNKAVAIL) return {};
  reader.check(error);
  std::vector<spng_text> texts(count);
  reader.check(spng_get_text(reader.ctx(), texts.data(), &count));
  Metadata result;
  for (const spng_text& text : texts) result.emplace_back(text.keyword, std::string(text.text, text.length));
  return result;
}

void check(int error) {
  if (error == SPNG_EMEM) throw std::bad_alloc();
  if (error != SPNG_OK) throw Error(fmt::format("cannot encode a PNG file: {}", spng_strerror(error)));
}

bool isAscii(const std::string& text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 128; });
}

// libspng keeps pointers to `texts` until the encoding ends.
void addText(spng_ctx* ctx, Metadata& texts) {
  std::vector<spng_text> chunks(texts.size());
  static char empty[] = "";
  for (std::size_t i = 0; i < texts.size(); ++i) {
    auto& [key, text] = texts[i];
    spng_text& chunk = chunks[i];
    std::memcpy(chunk.keyword, key.c_str(), key.size() + 1);
    chunk.type = isAscii(text) ? SPNG_TEXT : SPNG_ITXT;
    chunk.length = text.size();
    chunk.text = text.data();
    chunk.language_tag = empty;
    chunk.translated_keyword = empty;
  }
  if (!chunks.empty()) check(spng_set_text(ctx, chunks.data(), static_cast<std::uint32_t>(chunks.size())));
}

}  // namespace

const Format kPng{"PNG", matches, probe, decode, metadata};

std::vector<std::byte> encodePng(const Image& image, const Metadata& metadata) {
  checkEncodable(image, "PNG");
  checkMetadata(metadata);
  if (image.type == PixelType::f32) throw UsageError("PNG stores 8 or 16 bit samples, not floats");
  if (image.premultiplied && image.hasAlpha()) throw UsageError("PNG stores straight alpha, not premultiplied alpha");

  constexpr std::uint8_t kColorTypes[]{SPNG_COLOR_TYPE_GRAYSCALE, SPNG_COLOR_TYPE_GRAYSCALE_ALPHA,
                                       SPNG_COLOR_TYPE_TRUECOLOR, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA};
  spng_ihdr header{};
  header.width = image.width;
  header.height = image.height;
  header.bit_depth = static_cast<std::uint8_t>(8 * bytesPerSample(image.type));
  header.color_type = kColorTypes[image.channels - 1];

  const Context ctx = makeContext(SPNG_CTX_ENCODER);
  Metadata texts = metadata;
  std::erase_if(texts, [](const auto& entry) { return entry.second.empty(); });  // libspng rejects empty text
  check(spng_set_option(ctx.get(), SPNG_ENCODE_TO_BUFFER, 1));
  check(spng_set_option(ctx.get(), SPNG_IMG_COMPRESSION_LEVEL, kCompression));
  check(spng_set_ihdr(ctx.get(), &header));
  if (image.encoding == ColorEncoding::sRgb) {
    check(spng_set_srgb(ctx.get(), 0));  // intent: perceptual
  } else {
    check(spng_set_gama_int(ctx.get(), 100000));  // 1.0
  }
  addText(ctx.get(), texts);
  check(spng_encode_image(ctx.get(), image.data.data(), image.data.size(), SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE));

  std::size_t size = 0;
  int error = SPNG_OK;
  const std::unique_ptr<void, void (*)(void*)> buffer(spng_get_png_buffer(ctx.get(), &size, &error), std::free);
  check(error);
  const std::byte* begin = static_cast<const std::byte*>(buffer.get());
  return {begin, begin + size};
}

}  // namespace quintet::io
