// SPDX-License-Identifier: Apache-2.0
// KTX 2.0 files: formats, supercompression, orientation and swizzle, and files that are not valid.
#include <cmath>
#include <cstring>
#include <random>

#include <gmock/gmock.h>

#include "base/error.h"
#include "io/block_decode.h"
#include "io/codec.h"
#include "io/ktx2_builder.h"

namespace quintet::test {
namespace {

using io::BlockFormat;
using io::PixelType;
using testing::ElementsAre;
using testing::HasSubstr;

using io::test::Bytes;
using io::test::Ktx2;

Bytes bytesOf(std::initializer_list<int> values) {
  Bytes bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

io::Image decode(const Ktx2& file) { return io::decodeImage(file.build(), "a.ktx2"); }

std::string ktx2Error(const Bytes& bytes) {
  try {
    io::decodeImage(bytes, "a.ktx2");
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

template <class T>
std::vector<T> samplesOf(const io::Image& image) {
  const auto samples = image.samples<T>();
  return {samples.begin(), samples.end()};
}

TEST(Ktx2, ReadsBytes) {
  Ktx2 file{.width = 2, .height = 1, .level = bytesOf({1, 2, 3, 4, 5, 6, 7, 8})};
  for (const std::uint32_t scheme : {0u, 2u, 3u}) {
    file.scheme = scheme;
    const io::Image image = decode(file);
    EXPECT_EQ(image.width, 2u);
    EXPECT_EQ(image.channels, 4u);
    EXPECT_THAT(samplesOf<std::uint8_t>(image), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8)) << scheme;
  }
  file.scheme = 0;
  file.format = 44;  // BGRA
  EXPECT_THAT(samplesOf<std::uint8_t>(decode(file)), ElementsAre(3, 2, 1, 4, 7, 6, 5, 8));
  file = {.format = 29, .height = 2, .level = bytesOf({1, 2, 3, 4, 5, 6})};
  EXPECT_THAT(samplesOf<std::uint8_t>(decode(file)), ElementsAre(1, 2, 3, 4, 5, 6));
  file.addKey("KTXwriter", "by hand");
  file.addKey("KTXorientation", "ru");
  EXPECT_THAT(samplesOf<std::uint8_t>(decode(file)), ElementsAre(4, 5, 6, 1, 2, 3));
  file = {.format = 16, .level = bytesOf({10, 20})};
  EXPECT_THAT(samplesOf<std::uint8_t>(decode(file)), ElementsAre(10, 20, 0));
  file.addKey("KTXswizzle", "rrrg");
  EXPECT_THAT(samplesOf<std::uint8_t>(decode(file)), ElementsAre(10, 10, 10, 20));
  file = {.format = 9, .level = bytesOf({10})};
  EXPECT_THAT(samplesOf<std::uint8_t>(decode(file)), ElementsAre(10));
  file.addKey("KTXswizzle", "0r11");
  EXPECT_THAT(samplesOf<std::uint8_t>(decode(file)), ElementsAre(0, 10, 255));
}

TEST(Ktx2, ReadsWiderFormats) {
  EXPECT_THAT(samplesOf<std::uint16_t>(decode({.format = 84, .level = bytesOf({0, 1, 2, 3, 255, 255})})),
              ElementsAre(0x0100, 0x0302, 0xFFFF));
  // Half floats 1, -2, 2^-24 and infinity.
  const io::Image half = decode({.format = 97, .level = bytesOf({0x00, 0x3C, 0x00, 0xC0, 0x01, 0x00, 0x00, 0x7C})});
  EXPECT_THAT(samplesOf<float>(half), ElementsAre(1.0f, -2.0f, 0x1p-24f, INFINITY));
  EXPECT_EQ(half.encoding, io::ColorEncoding::linear);
  EXPECT_THAT(samplesOf<float>(decode({.format = 106, .level = bytesOf({0, 0, 128, 63, 0, 0, 0, 0, 0, 0, 0, 192})})),
              ElementsAre(1.0f, 0.0f, -2.0f));
  // Mantissas 256, 128 and 64 of 512 with the exponent 16: 1, 0.5 and 0.25.
  const std::uint32_t shared = 256u | 128u << 9 | 64u << 18 | 16u << 27;
  Bytes word(4);
  std::memcpy(word.data(), &shared, 4);
  EXPECT_THAT(samplesOf<float>(decode({.format = 123, .level = word})), ElementsAre(1.0f, 0.5f, 0.25f));
  const std::uint32_t packed = 15u << 6 | 16u << 17 | 14u << 27;  // 1, 2 and 0.5
  std::memcpy(word.data(), &packed, 4);
  EXPECT_THAT(samplesOf<float>(decode({.format = 122, .level = word})), ElementsAre(1.0f, 2.0f, 0.5f));
}

TEST(Ktx2, RejectsInvalidFiles) {
  const Ktx2 good{.level = bytesOf({1, 2, 3, 4})};
  EXPECT_EQ(ktx2Error(good.build()), "");
  const auto with = [&](auto change) {
    Ktx2 file = good;
    change(file);
    return ktx2Error(file.build());
  };
  EXPECT_THAT(with([](Ktx2& f) { f.level.pop_back(); }), HasSubstr("byte 96"));
  EXPECT_THAT(with([](Ktx2& f) { f.width = 0; }), HasSubstr("no pixels"));
  EXPECT_THAT(with([](Ktx2& f) { f.width = 100000; }), HasSubstr("too large"));
  EXPECT_THAT(with([](Ktx2& f) { f.layers = 2; }), HasSubstr("2D images"));
  EXPECT_THAT(with([](Ktx2& f) { f.faces = 6; }), HasSubstr("2D images"));
  EXPECT_THAT(with([](Ktx2& f) { f.depth = 1; }), HasSubstr("2D images"));
  EXPECT_THAT(with([](Ktx2& f) { f.format = 200; }), HasSubstr("format 200"));
  EXPECT_THAT(with([](Ktx2& f) { f.format = 0, f.scheme = 1; }), HasSubstr("color model 0"));
  EXPECT_THAT(with([](Ktx2& f) { f.scheme = 7; }), HasSubstr("supercompression scheme 7"));
  // A gigabyte that the file cannot hold is not allocated.
  for (const std::uint32_t scheme : {2u, 3u})
    EXPECT_THAT(with([&](Ktx2& f) { f.width = f.height = 16000, f.statedSize = 1024000000, f.scheme = scheme; }),
                HasSubstr("declares 1024000000 bytes"));
  // The header states more than the data holds, and the data holds more than the header states.
  for (const std::uint32_t scheme : {2u, 3u}) {
    EXPECT_THAT(with([&](Ktx2& f) { f.scheme = scheme, f.width = 2, f.statedSize = 8; }),
                HasSubstr("a.ktx2: byte 104"));
    EXPECT_THAT(with([&](Ktx2& f) { f.scheme = scheme, f.level.resize(400), f.statedSize = 4; }),
                HasSubstr("a.ktx2: byte 104"));
  }
  Bytes file = good.build();
  for (std::size_t size = 12; size < file.size(); ++size)
    EXPECT_THAT(ktx2Error({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)}), HasSubstr("early"))
        << size;
}

// ---- Blocks

io::Image decodeOne(BlockFormat format, const Bytes& block) { return io::decodeBlocks(format, block, 4, 4); }

TEST(BlockImages, InterpolatesColors) {
  // Red, blue, and two colors between them.
  const Bytes four = bytesOf({0x00, 0xF8, 0x1F, 0x00, 0b11100100, 0, 0, 0});
  std::vector<std::uint8_t> rgba = samplesOf<std::uint8_t>(decodeOne(BlockFormat::bc1Rgba, four));
  rgba.resize(16);
  EXPECT_THAT(rgba, ElementsAre(255, 0, 0, 255, 0, 0, 255, 255, 170, 0, 85, 255, 85, 0, 170, 255));
  // The mean, and black, which is transparent.
  const Bytes three = bytesOf({0x1F, 0x00, 0x00, 0xF8, 0b11100100, 0, 0, 0});
  rgba = samplesOf<std::uint8_t>(decodeOne(BlockFormat::bc1Rgba, three));
  rgba.resize(16);
  EXPECT_THAT(rgba, ElementsAre(0, 0, 255, 255, 255, 0, 0, 255, 128, 0, 128, 255, 0, 0, 0, 0));
  EXPECT_EQ(decodeOne(BlockFormat::bc1Rgb, three).channels, 3u);
  Bytes alpha = bytesOf({0x10, 0x32, 0, 0, 0, 0, 0, 0xF0});  // 4 bits each
  alpha.insert(alpha.end(), three.begin(), three.end());
  rgba = samplesOf<std::uint8_t>(decodeOne(BlockFormat::bc2, alpha));
  EXPECT_EQ(rgba[3], 0);
  EXPECT_EQ(rgba[7], 17);
  EXPECT_EQ(rgba[11], 34);
  EXPECT_EQ(rgba[63], 255);
  EXPECT_EQ(rgba[8], 170 - 85);  // always four colors
}

TEST(BlockImages, InterpolatesChannels) {
  // Indices 0 to 7: 240, 30, then sevenths.
  const Bytes eight = bytesOf({240, 30, 0x88, 0xC6, 0xFA, 0x88, 0xC6, 0xFA});
  const std::vector<std::uint16_t> values = samplesOf<std::uint16_t>(decodeOne(BlockFormat::bc4, eight));
  for (std::size_t i = 0; i < 8; ++i) {
    const double exact = i == 0 ? 240.0 : i == 1 ? 30.0 : 240.0 - 30.0 * static_cast<double>(i - 1);
    EXPECT_NEAR(values[i] * 255.0 / 65535.0, exact, 0.01) << i;
  }
  const Bytes six = bytesOf({30, 240, 0x88, 0xC6, 0xFA, 0x88, 0xC6, 0xFA});
  const std::vector<std::uint16_t> limits = samplesOf<std::uint16_t>(decodeOne(BlockFormat::bc4, six));
  EXPECT_EQ(limits[6], 0);
  EXPECT_EQ(limits[7], 65535);
  EXPECT_NEAR(limits[2] * 255.0 / 65535.0, 72.0, 0.01);
  const Bytes negative = bytesOf({0x81, 0x7F, 0x88, 0xC6, 0xFA, 0x88, 0xC6, 0xFA});  // -1 and 1
  const std::vector<float> values2 = samplesOf<float>(decodeOne(BlockFormat::bc4Signed, negative));
  EXPECT_THAT(std::vector<float>(values2.begin(), values2.begin() + 8),
              testing::Pointwise(testing::FloatNear(1e-6f), {-1.0f, 1.0f, -0.6f, -0.2f, 0.2f, 0.6f, -1.0f, 1.0f}));
  Bytes two = eight;
  two.insert(two.end(), six.begin(), six.end());
  const io::Image image = decodeOne(BlockFormat::bc5, two);
  EXPECT_EQ(image.channels, 3u);
  EXPECT_EQ(image.pixel<std::uint16_t>(0, 0)[0], values[0]);
  EXPECT_EQ(image.pixel<std::uint16_t>(3, 1)[1], 65535);
  EXPECT_EQ(image.pixel<std::uint16_t>(3, 1)[2], 0);
}

// Appends bits from the lowest one on.
struct BitWriter {
  Bytes block = Bytes(16);
  std::size_t at = 0;
  BitWriter& operator()(std::uint32_t value, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i, ++at) block[at / 8] |= static_cast<std::byte>((value >> i & 1) << (at % 8));
    return *this;
  }
};

TEST(BlockImages, DecodesBc7) {
  // Mode 6: endpoints (0, 64, 128, 255) and (255, 64, 0, 1) with the lowest bits 0 and 1. Texel i has index i.
  BitWriter six;
  six(1 << 6, 7)(0, 7)(127, 7)(32, 7)(31, 7)(64, 7)(0, 7)(127, 7)(0, 7)(0, 1)(1, 1)(0, 3);
  for (std::uint32_t i = 1; i < 16; ++i) six(i, 4);
  std::vector<std::uint8_t> rgba = samplesOf<std::uint8_t>(decodeOne(BlockFormat::bc7, six.block));
  EXPECT_THAT(std::vector<std::uint8_t>(rgba.begin(), rgba.begin() + 4), ElementsAre(0, 64, 128, 254));
  EXPECT_THAT(std::vector<std::uint8_t>(rgba.end() - 4, rgba.end()), ElementsAre(255, 63, 1, 1));
  EXPECT_EQ(rgba[4 * 8], (255 * 34 + 32) >> 6);
  // Mode 1, partition 13: the upper half is subset 0, the lower half subset 1. Both endpoints are equal.
  BitWriter one;
  one(2, 2)(13, 6);
  for (const std::uint32_t c : {63u, 63u, 0u, 0u, 0u, 0u, 63u, 63u, 32u, 32u, 32u, 32u}) one(c, 6);
  one(1, 1)(0, 1);
  rgba = samplesOf<std::uint8_t>(decodeOne(BlockFormat::bc7, one.block));
  for (std::size_t i = 0; i < 16; ++i) {
    const std::vector<std::uint8_t> texel(rgba.begin() + 4 * static_cast<std::ptrdiff_t>(i),
                                          rgba.begin() + 4 * static_cast<std::ptrdiff_t>(i) + 4);
    if (i < 8)
      EXPECT_THAT(texel, ElementsAre(255, 2, 131, 255)) << i;
    else
      EXPECT_THAT(texel, ElementsAre(0, 253, 129, 255)) << i;
  }
  // Mode 0, partition 0: subset s has the endpoints 0 and 30 of 31 in channel s. All bits of the indices are 1, so that
  // those of the anchors, texels 0, 3 and 15, are 3 instead of 7.
  BitWriter zero;
  zero(1, 1)(0, 4);
  for (std::uint32_t c = 0; c < 3; ++c)
    for (std::uint32_t e = 0; e < 6; ++e) zero(e == 2 * c + 1 ? 15 : 0, 4);
  zero(0, 6)(~0u, 32)(~0u, 13);
  rgba = samplesOf<std::uint8_t>(decodeOne(BlockFormat::bc7, zero.block));
  const std::string subsets = "0011001102212222";
  for (std::size_t i = 0; i < 16; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const bool own = c == static_cast<std::size_t>(subsets[i] - '0'), anchor = i == 0 || i == 3 || i == 15;
      EXPECT_EQ(rgba[4 * i + c], own ? (anchor ? (247 * 27 + 32) / 64 : 247) : 0) << i << ' ' << c;
    }
  // Mode 5 with rotation 1: red and alpha are exchanged.
  BitWriter five;
  five(1 << 5, 6)(1, 2)(127, 7)(127, 7)(0, 7)(0, 7)(64, 7)(64, 7)(10, 8)(10, 8);
  rgba = samplesOf<std::uint8_t>(decodeOne(BlockFormat::bc7, five.block));
  EXPECT_THAT(std::vector<std::uint8_t>(rgba.begin(), rgba.begin() + 4), ElementsAre(10, 0, 129, 255));
  EXPECT_THAT(samplesOf<std::uint8_t>(decodeOne(BlockFormat::bc7, Bytes(16))), testing::Each(0));
}

TEST(BlockImages, DecodesBc6) {
  // Mode 3: 10 bits per endpoint. The largest number is the largest half float.
  BitWriter three;
  three(3, 5)(1023, 10)(0, 10)(512, 10)(1023, 10)(0, 10)(512, 10);
  std::vector<float> rgb = samplesOf<float>(decodeOne(BlockFormat::bc6, three.block));
  EXPECT_EQ(rgb[0], 65504.0f);
  EXPECT_EQ(rgb[1], 0.0f);
  EXPECT_FLOAT_EQ(rgb[2], 1.0f + 527.0f / 1024.0f);  // (512 · 2^15 + 2^14) / 2^9 · 31 / 64 = 0x3E0F
  // Signed: -1 of 10 bits, and the smallest number.
  BitWriter negative;
  negative(3, 5)(1023, 10)(512, 10)(511, 10)(1023, 10)(512, 10)(511, 10);
  rgb = samplesOf<float>(decodeOne(BlockFormat::bc6Signed, negative.block));
  EXPECT_LT(rgb[0], 0.0f);
  EXPECT_GT(rgb[0], -1e-4f);
  EXPECT_EQ(rgb[1], -65504.0f);
  EXPECT_EQ(rgb[2], 65504.0f);
  // Mode 15: 16 bits and differences of 4 bits; the higher bits of endpoint 0 are reversed.
  BitWriter fifteen;
  fifteen(15, 5)(0, 10)(1, 10)(0, 10)(0xF, 4)(1, 6);
  rgb = samplesOf<float>(decodeOne(BlockFormat::bc6, fifteen.block));
  EXPECT_EQ(rgb[0], 1.5f);  // 0x8000 · 31 / 64 = 0x3E00
}

TEST(BlockImages, DecodeAnyBits) {
  std::mt19937 random(1);
  Bytes blocks(16 * 1024);
  for (std::byte& b : blocks) b = static_cast<std::byte>(random());
  for (int f = 1; f <= static_cast<int>(BlockFormat::bc7); ++f) {
    const auto format = static_cast<BlockFormat>(f);
    const io::Image image = io::decodeBlocks(format, blocks, 125, 127);
    EXPECT_EQ(image.data.size(), image.rowBytes() * 127);
    if (image.type == PixelType::f32) {
      for (const float v : image.samples<float>()) ASSERT_TRUE(std::isfinite(v)) << f;
    }
  }
}

TEST(Ktx2, ReadsBlocks) {
  const Bytes block = bytesOf({0x00, 0xF8, 0x00, 0xF8, 0, 0, 0, 0});
  Ktx2 file{.format = 132, .width = 5, .height = 3, .scheme = 2, .level = block};
  file.level.insert(file.level.end(), block.begin(), block.end());
  const io::Image image = decode(file);
  EXPECT_EQ(image.width, 5u);
  EXPECT_EQ(image.channels, 3u);
  EXPECT_THAT(image.pixel<std::uint8_t>(4, 2), ElementsAre(255, 0, 0));
  const io::ImageInfo info = io::probeImage(file.build(), "a");
  EXPECT_EQ(info.format, "KTX2");
  EXPECT_EQ(info.byteCount(), image.data.size());
}

}  // namespace
}  // namespace quintet::test
