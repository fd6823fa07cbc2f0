// SPDX-License-Identifier: Apache-2.0
#include "io/samples.h"

#include <turbojpeg.h>
#include <webp/encode.h>

#include <array>
#include <cmath>
#include <random>
#include <stdexcept>

#include "io/basis_samples.h"
#include "io/ktx2_builder.h"

namespace quintet::io::test {
namespace {

std::uint32_t crc32(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xffffffffu;
  for (const std::byte byte : bytes) {
    crc ^= static_cast<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  return ~crc;
}

std::string bigEndian(std::uint32_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 255);
  return text;
}

std::uint32_t readBigEndian(const Bytes& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint32_t>(bytes[at + i]);
  return value;
}

std::string chunk(const std::string& name, const std::string& data) {
  const std::string body = name + data;
  return bigEndian(static_cast<std::uint32_t>(data.size())) + body + bigEndian(crc32(std::as_bytes(std::span(body))));
}

std::string storedDeflate(const std::string& data) {
  const auto size = static_cast<std::uint32_t>(data.size());  // < 65536
  std::uint32_t a = 1;
  std::uint32_t b = 0;
  for (const unsigned char c : data) a = (a + c) % 65521, b = (b + a) % 65521;
  const std::string head{0x78,
                         0x01,
                         0x01,
                         static_cast<char>(size & 255),
                         static_cast<char>(size >> 8),
                         static_cast<char>(~size & 255),
                         static_cast<char>(~size >> 8 & 255)};
  return head + data + bigEndian(b << 16 | a);
}

// Different bytes.
Bytes ramp(std::size_t size) {
  Bytes bytes(size);
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(37 * i + 11);
  return bytes;
}

Bytes swizzledKtx2() {
  Ktx2 file{.format = 131, .width = 4, .height = 4, .level = ramp(8)};
  file.addKey("KTXorientation", "ru");
  file.addKey("KTXswizzle", "bgr1");
  return file.build();
}

}  // namespace

Bytes bytesOf(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

Image makeGradient(std::uint32_t width, std::uint32_t height, std::uint32_t channels, PixelType type) {
  Image image =
      makeImage(width, height, channels, type, type == PixelType::f32 ? ColorEncoding::linear : ColorEncoding::sRgb);
  std::minstd_rand random(width * 31 + height * 7 + channels);
  for (std::size_t i = 0; i < image.sampleCount(); ++i) {
    const std::size_t c = i % channels;
    const float x = static_cast<float>(i / channels % width) / static_cast<float>(width);
    const float y = static_cast<float>(i / channels / width) / static_cast<float>(height);
    const float noise = static_cast<float>(random() % 1000) / 50000.0f;
    float value = 0.4f + 0.2f * std::sin(3.0f * x + static_cast<float>(c)) + 0.3f * y + noise;
    if (image.hasAlpha() && c == channels - 1) value = (1.0f + x + y) / 3.0f;
    if (type == PixelType::u8) image.samples<std::uint8_t>()[i] = static_cast<std::uint8_t>(value * 255.0f);
    if (type == PixelType::u16) image.samples<std::uint16_t>()[i] = static_cast<std::uint16_t>(value * 65535.0f);
    if (type == PixelType::f32) image.samples<float>()[i] = image.hasAlpha() ? value : 4.0f * value * value;
  }
  return image;
}

Bytes encodeJpeg(const Image& image, int quality, int sampling, int flags) {
  const tjhandle handle = tjInitCompress();
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const int format = image.channels == 1 ? TJPF_GRAY : image.channels == 3 ? TJPF_RGB : TJPF_CMYK;
  if (tjCompress2(handle, image.samples<std::uint8_t>().data(), static_cast<int>(image.width), 0,
                  static_cast<int>(image.height), format, &buffer, &size, sampling, quality, flags) != 0)
    throw std::runtime_error(tjGetErrorStr2(handle));
  const auto* begin = reinterpret_cast<const std::byte*>(buffer);
  Bytes result(begin, begin + size);
  tjFree(buffer);
  tjDestroy(handle);
  return result;
}

Bytes encodeWebp(const Image& image, float quality) {
  const std::uint8_t* pixels = image.samples<std::uint8_t>().data();
  const int width = static_cast<int>(image.width);
  const int height = static_cast<int>(image.height);
  const int stride = static_cast<int>(image.rowBytes());
  const bool alpha = image.channels == 4;
  std::uint8_t* buffer = nullptr;
  std::size_t size = 0;
  if (quality < 0.0f) {
    size = alpha ? WebPEncodeLosslessRGBA(pixels, width, height, stride, &buffer)
                 : WebPEncodeLosslessRGB(pixels, width, height, stride, &buffer);
  } else {
    size = alpha ? WebPEncodeRGBA(pixels, width, height, stride, quality, &buffer)
                 : WebPEncodeRGB(pixels, width, height, stride, quality, &buffer);
  }
  const auto* begin = reinterpret_cast<const std::byte*>(buffer);
  Bytes result(begin, begin + size);
  WebPFree(buffer);
  return result;
}

Bytes makePng(const PngParts& parts) {
  std::string text = "\x89PNG\r\n\x1a\n";
  text += chunk("IHDR", bigEndian(parts.width) + bigEndian(parts.height) +
                            std::string{static_cast<char>(parts.bitDepth), static_cast<char>(parts.colorType), 0, 0,
                                        static_cast<char>(parts.interlace)});
  for (const auto& [name, data] : parts.chunks) text += chunk(name, data);
  text += chunk("IDAT", storedDeflate(parts.rows)) + chunk("IEND", "");
  return bytesOf(text);
}

void repairPngChecksums(Bytes& png) {
  for (std::size_t at = 8; at + 12 <= png.size();) {
    const std::size_t size = readBigEndian(png, at);
    if (size > png.size() - at - 12) return;
    const std::string crc = bigEndian(crc32(std::span(png).subspan(at + 4, size + 4)));
    for (std::size_t i = 0; i < 4; ++i) png[at + 8 + size + i] = static_cast<std::byte>(crc[i]);
    at += 12 + size;
  }
}

std::vector<Sample> allSamples() {
  const auto image = [](std::uint32_t channels, PixelType type = PixelType::u8) {
    return makeGradient(12, 9, channels, type);
  };
  PngParts palette{5, 2, 2, 3, 0, {{"PLTE", std::string("\1\2\3\4\5\6\7\x8\x9", 9)}, {"tRNS", "\x80"}}, {}};
  palette.rows = std::string("\0\x18\x40\0\x24\x80", 6);
  PngParts interlaced{3, 3, 8, 0, 1, {}, {}};
  interlaced.rows = std::string(
      "\0\1"
      "\0\2"
      "\0\3\4"
      "\0\5"
      "\0\6"
      "\0\7\x8\x9",
      15);
  const std::string flat = "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + std::string(16, '\x80');
  const std::string oldRuns = "#?RADIANCE\n\n-Y 1 +X 9\n\x80\x40\x20\x81\1\1\1\4\x80\x80\x80\x80\1\1\1\3";
  return {
      {"png8.png", encodePng(image(3), {{"Title", "a"}, {"Comment", "\u00e4\u00f6"}})},
      {"png16.png", encodePng(image(4, PixelType::u16))},
      {"palette.png", makePng(palette)},
      {"interlaced.png", makePng(interlaced)},
      {"baseline.jpg", encodeJpeg(image(3), 90, TJSAMP_420, 0)},
      {"progressive.jpg", encodeJpeg(image(3), 90, TJSAMP_444, TJFLAG_PROGRESSIVE)},
      {"gray.jpg", encodeJpeg(image(1), 90, TJSAMP_GRAY, 0)},
      {"lossy.webp", encodeWebp(image(3), 80.0f)},
      {"lossy_alpha.webp", encodeWebp(image(4), 80.0f)},
      {"lossless.webp", encodeWebp(image(4), -1.0f)},
      {"new_runs.hdr", encodeHdr(image(3, PixelType::f32))},
      {"old_runs.hdr", bytesOf(oldRuns)},
      {"flat.hdr", bytesOf(flat)},
      {"zip.exr", encodeExr(image(4, PixelType::f32), {{"Title", "a"}})},
      {"tiled.exr", makeExr(ExrKind::tiled)},
      {"mipmapped.exr", makeExr(ExrKind::mipmapped)},
      {"windows.exr", makeExr(ExrKind::offsetWindows)},
      {"multipart.exr", makeExr(ExrKind::multiPart)},
      {"piz.exr", makeExr(ExrKind::piz)},
      {"rgba8.ktx2", Ktx2{.width = 2, .height = 2, .level = Bytes(16, std::byte{7})}.build()},
      {"zstd.ktx2", Ktx2{.format = 97, .width = 3, .height = 2, .scheme = 2, .level = ramp(48)}.build()},
      {"zlib.ktx2", Ktx2{.format = 145, .width = 5, .height = 4, .scheme = 3, .level = ramp(32)}.build()},
      {"swizzled.ktx2", swizzledKtx2()},
      {"etc1s.ktx2", etc1sFile()},
      {"etc1s_alpha.ktx2", etc1sAlphaFile()},
      {"uastc.ktx2", uastcFile()},
  };
}

}  // namespace quintet::io::test
