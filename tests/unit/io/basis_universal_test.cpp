// SPDX-License-Identifier: Apache-2.0
// Basis Universal in KTX2: ETC1S with BasisLZ, and UASTC. The hashes are those of the pixels of the reference transcoder
// (basis_transcoder.wasm of npm's three 0.187.0, format RGBA32); basis_reference_test.cpp compares every byte with it.
#include <array>
#include <cstring>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "base/error.h"
#include "io/basis_bits.h"
#include "io/basis_lz_builder.h"
#include "io/basis_samples.h"
#include "io/block_decode.h"
#include "io/codec.h"

namespace quintet::test {
namespace {

using io::test::BasisLzImage;
using io::test::Bytes;
using io::test::Ktx2;
using testing::ElementsAre;
using testing::HasSubstr;

io::Image decoded(const Bytes& file) {
  const io::ImageInfo info = io::probeImage(file, "a.ktx2");
  const io::Image image = io::decodeImage(file, "a.ktx2");
  EXPECT_EQ(info.channels, image.channels);
  EXPECT_EQ(info.byteCount(), image.data.size());
  return image;
}

std::string errorFor(const Bytes& file) {
  try {
    (void)io::decodeImage(file, "a.ktx2");
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

// FNV-1a with 64 bits, of the pixels as RGBA.
std::uint64_t pixelHash(const io::Image& image) {
  std::uint64_t hash = 0xCBF29CE484222325u;
  const io::Image rgba = io::toChannels(image, 4);
  for (const std::uint8_t value : rgba.samples<std::uint8_t>()) hash = (hash ^ value) * 0x100000001B3u;
  return hash;
}

TEST(BasisUniversal, ReadsFilesOfTheEncoder) {
  io::Image image = decoded(io::test::etc1sFile());
  EXPECT_EQ(image.width, 30u);
  EXPECT_EQ(image.height, 22u);
  EXPECT_EQ(image.channels, 3u);
  EXPECT_EQ(pixelHash(image), 0x568C398CF5047594u);
  image = decoded(io::test::etc1sAlphaFile());
  EXPECT_EQ(image.channels, 4u);
  EXPECT_EQ(pixelHash(image), 0x0C3A704737312F84u);
  image = decoded(io::test::uastcFile());
  EXPECT_EQ(image.channels, 4u);
  EXPECT_EQ(pixelHash(image), 0x8A35DD58864AC888u);
}

// ---- UASTC ----

constexpr std::array<std::array<std::uint32_t, 2>, 19> kModeCodes{// code and number of bits of each mode
                                                                  {{0x01, 4},
                                                                   {0x35, 6},
                                                                   {0x1D, 5},
                                                                   {0x03, 5},
                                                                   {0x13, 5},
                                                                   {0x0B, 5},
                                                                   {0x1B, 5},
                                                                   {0x07, 5},
                                                                   {0x17, 5},
                                                                   {0x0F, 5},
                                                                   {0x02, 3},
                                                                   {0x00, 2},
                                                                   {0x06, 3},
                                                                   {0x1F, 5},
                                                                   {0x0D, 5},
                                                                   {0x05, 7},
                                                                   {0x15, 6},
                                                                   {0x25, 6},
                                                                   {0x09, 4}}};

void setBits(std::span<std::byte> block, std::size_t at, std::size_t count, std::size_t value) {
  for (std::size_t i = 0; i < count; ++i, ++at) {
    block[at / 8] &= ~static_cast<std::byte>(1u << (at % 8));
    block[at / 8] |= static_cast<std::byte>((value >> i & 1u) << (at % 8));
  }
}

// 64 blocks of a mode with arbitrary bits and valid patterns. `state` is that of the random number generator.
Bytes blocksOfMode(std::size_t mode, std::uint32_t& state) {
  struct Pattern {
    std::size_t mode, at, bits, count;
  };
  constexpr Pattern kPatterns[] = {{2, 20, 5, 30}, {3, 20, 4, 11}, {4, 20, 5, 30},
                                   {7, 20, 5, 19}, {9, 28, 5, 30}, {16, 29, 5, 30}};
  Bytes bytes(64 * 16);
  for (std::byte& b : bytes) b = static_cast<std::byte>((state = state * 1664525u + 1013904223u) >> 24);
  for (std::size_t k = 0; k < 64; ++k) {
    const std::span<std::byte> block = std::span(bytes).subspan(16 * k, 16);
    setBits(block, 0, kModeCodes[mode][1], kModeCodes[mode][0]);
    for (const Pattern& pattern : kPatterns)
      if (pattern.mode == mode) setBits(block, pattern.at, pattern.bits, k % pattern.count);
  }
  return bytes;
}

TEST(BasisUniversal, DecodesAllModesOfUastc) {
  constexpr std::uint64_t kHashes[] = {0x2503CE01E8D2EF44, 0x72AAEFA49A932D80, 0x41DE65330EDD9F26, 0xE1E052A627AFE925,
                                       0xF28BE88AC2FBC93F, 0x3AA6FAA779095EF3, 0xF846BFBC25C60346, 0x7F6D71326A5AE66D,
                                       0x075D4741509687A5, 0x93516017F53C4EFC, 0xDF35854E869A0148, 0x9E953A3EE20B03FB,
                                       0xAF6CE122F3C6A82B, 0xB02655CB2311751A, 0x15E9CF6A26FB3F5D, 0x8BB417247659E499,
                                       0x8C639848A43641C6, 0x5BFA7CD8CBE822C1, 0xB7D9846B2EB3FEAD};
  std::uint32_t state = 1;
  for (std::size_t mode = 0; mode < kModeCodes.size(); ++mode) {
    Ktx2 file{.format = 0, .width = 32, .height = 32, .level = blocksOfMode(mode, state)};
    file.describe(166, {3});
    EXPECT_EQ(pixelHash(decoded(file.build())), kHashes[mode]) << mode;
    file.scheme = 2;  // Zstandard
    EXPECT_EQ(pixelHash(decoded(file.build())), kHashes[mode]) << mode;
  }
}

// The example of the Data Format Specification: the digit 4 and the bits 2 of mode 7 are the endpoint 58.
TEST(BasisUniversal, ScalesEndpointsOfUastc) {
  Bytes block(16);
  setBits(block, 0, 5, 7);
  for (std::size_t group = 0; group < 4; ++group) setBits(block, 25 + 7 * group, 7, 4 * 25 + 4 * 5 + 4);
  for (std::size_t e = 0; e < 12; ++e) setBits(block, 53 + 3 * e, 3, 2);
  std::array<std::uint8_t, 64> rgba{};
  io::decodeUastcBlock(block.data(), rgba.data());
  for (std::size_t i = 0; i < 64; ++i) EXPECT_EQ(rgba[i], i % 4 == 3 ? 255 : 58) << i;
}

TEST(BasisUniversal, ShowsInvalidBlocksOfUastc) {
  const auto colorOf = [](std::size_t code, std::size_t at, std::size_t bits, std::size_t pattern) {
    Bytes block(16);
    setBits(block, 0, 7, code);
    setBits(block, at, bits, pattern);
    std::array<std::uint8_t, 64> rgba{};
    io::decodeUastcBlock(block.data(), rgba.data());
    return std::vector<std::uint8_t>(rgba.end() - 4, rgba.end());
  };
  const auto magenta = ElementsAre(255, 0, 255, 255);
  EXPECT_THAT(colorOf(0x45, 20, 5, 0), magenta);  // the reserved mode
  EXPECT_THAT(colorOf(0x75 ^ 0x40, 20, 5, 0), testing::Not(magenta));
  EXPECT_THAT(colorOf(0x1D, 20, 5, 29), testing::Not(magenta));
  EXPECT_THAT(colorOf(0x1D, 20, 5, 30), magenta);
  EXPECT_THAT(colorOf(0x03, 20, 4, 10), testing::Not(magenta));
  EXPECT_THAT(colorOf(0x03, 20, 4, 11), magenta);
  EXPECT_THAT(colorOf(0x07, 20, 5, 18), testing::Not(magenta));
  EXPECT_THAT(colorOf(0x07, 20, 5, 19), magenta);
}

TEST(BasisUniversal, ArrangesTheChannelsOfUastc) {
  Ktx2 file{.format = 0, .width = 3, .height = 2, .level = Bytes(16)};
  setBits(file.level, 0, 5, 0x17);  // one color
  for (std::size_t c = 0; c < 4; ++c) setBits(file.level, 5 + 8 * c, 8, 10 * (c + 1));
  const auto pixel = [&](int channel, const std::string& swizzle = "") {
    Ktx2 changed = file;
    changed.describe(166, {channel});
    if (!swizzle.empty()) changed.addKey("KTXswizzle", swizzle);
    const io::Image image = decoded(changed.build());
    const auto samples = image.pixel<std::uint8_t>(2, 1);
    return std::vector<std::uint8_t>(samples.begin(), samples.end());
  };
  EXPECT_THAT(pixel(0), ElementsAre(10, 20, 30));
  EXPECT_THAT(pixel(3), ElementsAre(10, 20, 30, 40));
  EXPECT_THAT(pixel(4), ElementsAre(10));
  EXPECT_THAT(pixel(5), ElementsAre(10, 40, 0));
  EXPECT_THAT(pixel(6), ElementsAre(10, 20, 0));
  EXPECT_THAT(pixel(5, "rrrg"), ElementsAre(10, 10, 10, 40));
  EXPECT_THAT(pixel(0, "bgr1"), ElementsAre(30, 20, 10));
  file.describe(166, {9});
  EXPECT_THAT(errorFor(file.build()), HasSubstr("channels 9"));
}

TEST(BasisUniversal, KeepsPremultipliedAlpha) {
  Ktx2 file{.format = 0, .level = Bytes(16)};
  setBits(file.level, 0, 5, 0x17);
  for (const std::uint32_t flags : {0u, 1u}) {
    file.describe(166, {3}, flags);
    EXPECT_EQ(decoded(file.build()).premultiplied, flags == 1);
  }
  file.describe(166, {0}, 1);  // without alpha
  EXPECT_FALSE(decoded(file.build()).premultiplied);
}

// ---- ETC1S ----

void expectPixels(const io::Image& image, const BasisLzImage& expected, const std::vector<std::size_t>& slices) {
  ASSERT_EQ(image.channels, slices.size());
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x)
      for (std::size_t c = 0; c < slices.size(); ++c) {
        // Slice 0 has the channels red, green and blue; of slice 1 green counts.
        const std::uint8_t value = slices[c] == 1 ? expected.value(1, x, y, 1) : expected.value(0, x, y, c);
        ASSERT_EQ(image.pixel<std::uint8_t>(x, y)[c], value) << x << ' ' << y << ' ' << c;
      }
}

// Every kind of symbol, in images of several sizes.
TEST(BasisUniversal, ReadsWhatBasisLzOffers) {
  std::mt19937 random(7);
  for (int i = 0; i < 48; ++i) {
    BasisLzImage image;
    image.width = i == 0 ? 1 : static_cast<std::uint32_t>(1 + random() % (i % 4 == 0 ? 300 : 60));
    image.height = i == 0 ? 1 : static_cast<std::uint32_t>(1 + random() % 60);
    image.gray = i % 3 == 1, image.rawSelectors = i % 5 == 1, image.skewed = i % 2 == 1;
    image.historySize = std::array{0u, 1u, 7u, 64u}[random() % 4];
    const std::size_t slices = 1 + random() % 2;
    image.fill(random, i == 1 ? 1 : 1 + random() % 200, i == 1 ? 1 : 1 + random() % 300, slices);
    const Bytes file = (slices == 2 ? image.file(random, {0, 15}) : image.file(random, {0})).build();
    SCOPED_TRACE(i);
    expectPixels(decoded(file), image,
                 slices == 2 ? std::vector<std::size_t>{0, 0, 0, 1} : std::vector<std::size_t>{0, 0, 0});
  }
}

TEST(BasisUniversal, ArrangesTheChannelsOfEtc1s) {
  std::mt19937 random(3);
  BasisLzImage image{.width = 9, .height = 6};
  image.fill(random, 20, 20, 2);
  expectPixels(decoded(image.file(random, {3}).build()), image, {0});  // red
  const io::Image pair = decoded(image.file(random, {3, 4}).build());  // red and green
  ASSERT_EQ(pair.channels, 3u);
  for (std::uint32_t x = 0; x < 9; ++x)
    EXPECT_THAT(pair.pixel<std::uint8_t>(x, 5), ElementsAre(image.value(0, x, 5, 0), image.value(1, x, 5, 1), 0));
  Ktx2 turned = image.file(random, {0, 15});
  turned.addKey("KTXorientation", "ru");
  turned.addKey("KTXswizzle", "ab0r");
  const io::Image result = decoded(turned.build());
  EXPECT_THAT(result.pixel<std::uint8_t>(4, 0),
              ElementsAre(image.value(1, 4, 5, 1), image.value(0, 4, 5, 2), 0, image.value(0, 4, 5, 0)));
}

// ---- Files that are not valid ----

TEST(BasisUniversal, RejectsOtherFiles) {
  Ktx2 file{.format = 0, .level = Bytes(16)};
  file.describe(166, {3});
  const auto with = [&](auto change) {
    Ktx2 changed = file;
    change(changed);
    return errorFor(changed.build());
  };
  EXPECT_EQ(with([](Ktx2&) {}), "");
  EXPECT_THAT(with([](Ktx2& f) { f.describe(167, {3}); }), HasSubstr("byte 12: KTX2 with the color model 167"));
  EXPECT_THAT(with([](Ktx2& f) { f.describe(166, {}); }), HasSubstr("byte 48"));
  EXPECT_THAT(with([](Ktx2& f) { f.descriptor.clear(); }), HasSubstr("color model 0"));
  EXPECT_THAT(with([](Ktx2& f) { f.descriptor.resize(40); }), HasSubstr("byte 48"));
  EXPECT_THAT(with([](Ktx2& f) { f.layers = 3; }), HasSubstr("byte 28"));
  EXPECT_THAT(with([](Ktx2& f) { f.faces = 6; }), HasSubstr("cube"));
  EXPECT_THAT(with([](Ktx2& f) { f.level.resize(32); }), HasSubstr("states 32 bytes"));
  EXPECT_THAT(with([](Ktx2& f) { f.scheme = 1; }), HasSubstr("color model 166"));
  EXPECT_THAT(with([](Ktx2& f) { f.format = 43, f.scheme = 1; }), HasSubstr("supercompression scheme 1"));
}

TEST(BasisUniversal, RejectsInvalidBasisLz) {
  std::mt19937 random(5);
  BasisLzImage image{.width = 16, .height = 16};
  image.fill(random, 9, 9, 1);
  image.endpoints[0].color[0] = 3;
  const Ktx2 good = image.file(random, {0});
  ASSERT_EQ(errorFor(good.build()), "");
  // The global data is behind the header and the descriptor, of one sample.
  const std::string at = "byte ";
  constexpr std::size_t kGlobal = 104 + 44;
  const auto with = [&](std::size_t offset, std::uint32_t word) {
    Ktx2 changed = good;
    std::memcpy(changed.globalData.data() + offset, &word, 4);
    return errorFor(changed.build());
  };
  EXPECT_THAT(with(0, 9u << 16), HasSubstr("without endpoints"));
  EXPECT_THAT(with(0, 9u), HasSubstr("without endpoints"));
  for (const std::size_t field : {4u, 8u, 12u})
    EXPECT_THAT(with(field, 1u << 30),
                HasSubstr(at + std::to_string(kGlobal + field) + ": a part of the BasisLZ data"));
  EXPECT_THAT(with(20, 2), HasSubstr(at + std::to_string(kGlobal + 20) + ": KTX2 with the frames of a video"));
  EXPECT_THAT(with(24, 1000), HasSubstr("outside of level 0"));
  EXPECT_THAT(with(28, 0xFFFFFFFF), HasSubstr("outside of level 0"));
  EXPECT_THAT(with(28, 0), HasSubstr("is missing"));
  EXPECT_THAT(with(28, 1), HasSubstr("ends early"));
  Ktx2 changed = good;
  changed.describe(163, {0, 15});  // a second slice that does not exist
  EXPECT_THAT(errorFor(changed.build()), HasSubstr("is missing"));
  changed = good;
  changed.globalData.resize(30);
  EXPECT_THAT(errorFor(changed.build()), HasSubstr("ends early"));

  // A block may not refer to a block outside of the image: no difference is stored for the first one.
  BasisLzImage one{.width = 4, .height = 4};
  one.fill(random, 1, 1, 1);
  for (std::uint32_t prediction = 0; prediction < 3; ++prediction) {
    Ktx2 file = one.file(random, {0});
    io::test::BasisBitWriter bits;
    io::test::BasisCodeWriter(257, false).write(bits, prediction);
    bits(0, 16);
    file.level = bits.bytes();
    const auto length = static_cast<std::uint32_t>(file.level.size());
    std::memcpy(file.globalData.data() + 28, &length, 4);
    EXPECT_THAT(errorFor(file.build()), HasSubstr("outside of the image")) << prediction;
  }
}

TEST(BasisUniversal, RejectsInvalidHuffmanTables) {
  const std::string name = "a";
  const auto read = [&](const std::vector<std::uint8_t>& lengths, std::uint32_t symbol) -> std::string {
    io::test::BasisBitWriter bits;
    const io::test::BasisCodeWriter writer(lengths);
    writer.writeTable(bits);
    writer.write(bits, symbol);
    bits(0, 7);
    const io::Source source{bits.bytes(), name};
    io::BasisBits reader(source, 0, source.size());
    try {
      const io::BasisCode code(reader);
      return std::to_string(code(reader));
    } catch (const FileError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(read({1, 1}, 1), "1");
  EXPECT_EQ(read({0, 0, 1}, 2), "2");
  // Codes of up to 16 bits.
  std::vector<std::uint8_t> lengths;
  for (std::uint8_t length = 1; length <= 16; ++length) lengths.push_back(length);
  lengths.push_back(16);
  for (std::uint32_t symbol = 0; symbol < lengths.size(); ++symbol)
    EXPECT_EQ(read(lengths, symbol), std::to_string(symbol));
  EXPECT_THAT(read({1, 2}, 0), HasSubstr("Huffman table"));     // not complete
  EXPECT_THAT(read({1, 1, 1}, 0), HasSubstr("Huffman table"));  // too many
  EXPECT_THAT(read({0, 0, 0}, 0), HasSubstr("Huffman code"));   // no symbol
}

}  // namespace
}  // namespace quintet::test
