// SPDX-License-Identifier: Apache-2.0
#include "io/exr/exr.h"
#include "io/codec.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/samples.h"

namespace quintet::io {
namespace {

using test::ExrKind;
using test::makeExr;
using test::makeGradient;
using testing::ElementsAre;
using testing::FloatNear;
using testing::HasSubstr;
using testing::Pointwise;

std::string exrError(const test::Bytes& bytes) {
  try {
    decodeImage(bytes, "a.exr");
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ExrTest, RoundTripsImages) {
  for (std::uint32_t channels = 1; channels <= 4; ++channels) {
    const Image image = toPremultiplied(makeGradient(37, 21, channels, PixelType::f32));
    const Image back = decodeImage(encodeExr(image), "a.exr");
    ASSERT_EQ(back.width, 37u);
    ASSERT_EQ(back.height, 21u);
    ASSERT_EQ(back.channels, channels);
    EXPECT_EQ(back.encoding, ColorEncoding::linear);
    EXPECT_EQ(back.premultiplied, back.hasAlpha());
    // Half has a mantissa of 11 bits.
    EXPECT_THAT(back.samples<float>(), Pointwise(FloatNear(4.0f / 2048.0f), image.samples<float>()));
  }
}

TEST(ExrTest, MultipliesStraightAlpha) {
  Image image = makeImage(1, 1, 4, PixelType::f32, ColorEncoding::linear);
  std::ranges::copy(std::array{1.0f, 2.0f, 4.0f, 0.5f}, image.samples<float>().begin());
  EXPECT_THAT(decodeImage(encodeExr(image), "a").samples<float>(), ElementsAre(0.5f, 1.0f, 2.0f, 0.5f));
}

TEST(ExrTest, KeepsChannelsTypesAndMetadata) {
  const float inf = std::numeric_limits<float>::infinity();
  const ExrImage image{3,
                       1,
                       {{"B", ExrType::half, {1.0f, 70000.0f, -inf}},
                        {"albedo.R", ExrType::f32, {0.1f, 1e30f, -0.0f}},
                        {"sampleCount", ExrType::u32, {7.0f, 16777215.0f, -3.0f}}},
                       {{"quintet.scene", "\u00e4"}, {"software", ""}}};
  const ExrImage back = decodeExr(encodeExr(image), "a.exr");
  ASSERT_EQ(back.channels.size(), 3u);
  EXPECT_EQ(back.channels[0].name, "B");
  EXPECT_EQ(back.channels[0].type, ExrType::half);
  EXPECT_THAT(back.channels[0].samples, ElementsAre(1.0f, 65504.0f, -inf));
  EXPECT_EQ(back.channels[1].name, "albedo.R");
  EXPECT_EQ(back.channels[1].type, ExrType::f32);
  EXPECT_EQ(back.channels[1].samples, image.channels[1].samples);
  EXPECT_EQ(back.channels[2].type, ExrType::u32);
  EXPECT_THAT(back.channels[2].samples, ElementsAre(7.0f, 16777215.0f, 0.0f));
  EXPECT_EQ(back.metadata, image.metadata);
  EXPECT_EQ(readMetadata(encodeExr(image), "a.exr"), image.metadata);
}

TEST(ExrTest, RejectsInvalidImages) {
  const ExrImage good{1, 1, {{"A", ExrType::half, {1.0f}}}, {}};
  EXPECT_NO_THROW(encodeExr(good));
  const auto with = [&](auto&& change) {
    ExrImage image = good;
    change(image);
    return image;
  };
  EXPECT_THROW(encodeExr(with([](ExrImage& p) { p.channels[0].samples.push_back(0.0f); })), UsageError);
  EXPECT_THROW(encodeExr(with([](ExrImage& p) { p.channels.push_back(p.channels[0]); })), UsageError);
  EXPECT_THROW(encodeExr(with([](ExrImage& p) { p.channels.clear(); })), UsageError);
  EXPECT_THROW(encodeExr(with([](ExrImage& p) { p.channels[0].name.clear(); })), UsageError);
  EXPECT_THROW(encodeExr(with([](ExrImage& p) { p.width = 0; })), UsageError);
  for (const char* key : {"compression", "dataWindow", "type", "chunkCount"})
    EXPECT_THROW(encodeExr(with([&](ExrImage& p) { p.metadata = {{key, "x"}}; })), UsageError) << key;
  EXPECT_THROW(encodeExr(with([](ExrImage& p) { p.metadata = {{"a", "x"}, {"a", "y"}}; })), UsageError);
}

TEST(ExrTest, ReadsTilesAndPiz) {
  for (const ExrKind kind : {ExrKind::tiled, ExrKind::mipmapped, ExrKind::piz}) {
    const Image image = decodeImage(makeExr(kind), "a.exr");
    ASSERT_EQ(image.width, 10u);
    ASSERT_EQ(image.height, 6u);
    for (std::uint32_t y = 0; y < 6; ++y)
      for (std::uint32_t x = 0; x < 10; ++x)
        ASSERT_EQ(image.pixel<float>(x, y).back(), static_cast<float>(100 * y + x));
  }
}

TEST(ExrTest, CropsToTheDisplayWindow) {
  // Display (10,20) … (14,23), data (8,21) … (12,30).
  const Image image = decodeImage(makeExr(ExrKind::offsetWindows), "a.exr");
  ASSERT_EQ(image.width, 5u);
  ASSERT_EQ(image.height, 4u);
  ASSERT_EQ(image.channels, 4u);
  EXPECT_THAT(image.pixel<float>(0, 0), ElementsAre(0, 0, 0, 0));              // above the data
  EXPECT_THAT(image.pixel<float>(3, 1), ElementsAre(0, 0, 0, 0));              // right of the data
  EXPECT_THAT(image.pixel<float>(0, 1), ElementsAre(5110, 4110, 3110, 2110));  // A, B, G, R differ by 1000
  EXPECT_THAT(image.pixel<float>(2, 3), ElementsAre(5312, 4312, 3312, 2312));
}

TEST(ExrTest, FindsTheImageInLayersAndParts) {
  const Image layer = decodeImage(makeExr(ExrKind::layers), "a.exr");
  EXPECT_EQ(layer.channels, 4u);
  EXPECT_THAT(layer.pixel<float>(1, 2), ElementsAre(4201, 3201, 2201, 1201));
  EXPECT_EQ(decodeExr(makeExr(ExrKind::layers), "a.exr").channels.size(), 5u);
  const Image part = decodeImage(makeExr(ExrKind::multiPart), "a.exr");
  EXPECT_EQ(part.channels, 3u);
  EXPECT_THAT(part.pixel<float>(1, 2), ElementsAre(2201, 1201, 201));

  const ExrImage noImage{1, 1, {{"U", ExrType::half, {1.0f}}, {"V", ExrType::half, {1.0f}}}, {}};
  EXPECT_THAT(exrError(encodeExr(noImage)), HasSubstr("U, V"));
  const ExrImage depth{1, 1, {{"Z", ExrType::f32, {3.0f}}}, {}};
  EXPECT_THAT(decodeImage(encodeExr(depth), "a").samples<float>(), ElementsAre(3.0f));
}

TEST(ExrTest, RejectsHostileHeaders) {
  const test::Bytes good = encodeExr(makeGradient(8, 8, 3, PixelType::f32));
  const std::string text(reinterpret_cast<const char*>(good.data()), good.size());
  const auto withInt = [&](std::size_t at, std::uint32_t value) {
    test::Bytes bytes = good;
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::byte>(value >> (8 * i));
    return bytes;
  };
  const std::size_t window = text.find("dataWindow") + 10 + 1 + 5 + 1 + 4;  // name, type, size
  EXPECT_THAT(exrError(withInt(window + 8, 0x7fffffff)), HasSubstr("dataWindow is out of range"));
  EXPECT_THAT(exrError(withInt(window + 8, 100000)), HasSubstr("too large"));
  EXPECT_THAT(exrError(withInt(window + 8, 0xffffffff)), HasSubstr("dataWindow is empty"));
  EXPECT_THAT(exrError(withInt(window + 12, 60000)), HasSubstr("a.exr: "));
  const std::size_t size = text.find("box2i") + 6;
  EXPECT_THAT(exrError(withInt(size, 0x7fffffff)), HasSubstr("'dataWindow' is larger than the file"));
  EXPECT_THAT(exrError(withInt(4, 0x7fffffff)), HasSubstr("a.exr: "));  // version
}

// OpenEXR reads values of these types without regard to the stated size, and allocates what they state.
TEST(ExrTest, RejectsAttributesOfWrongSize) {
  const test::Bytes good = encodeExr(makeGradient(8, 8, 3, PixelType::f32));
  const std::string text(reinterpret_cast<const char*>(good.data()), good.size());
  EXPECT_EQ(exrError(good), "no error");
  test::Bytes noChannels = good;
  noChannels[text.find("chlist") + 7 + 4] = std::byte{0};  // the list ends at its beginning
  EXPECT_THAT(exrError(noChannels), HasSubstr("'channels' has a wrong size"));
  // An attribute after the magic number and the version.
  const auto errorWith = [&](const std::string& type, const std::vector<std::uint32_t>& value) {
    std::string attribute = "extra" + std::string(1, '\0') + type + '\0';
    std::vector<std::uint32_t> words{static_cast<std::uint32_t>(4 * value.size())};
    words.insert(words.end(), value.begin(), value.end());
    attribute.append(reinterpret_cast<const char*>(words.data()), 4 * words.size());
    return exrError(test::bytesOf(text.substr(0, 8) + attribute + text.substr(8)));
  };
  constexpr const char* kProblem = "'extra' has a wrong size";
  EXPECT_THAT(errorWith("preview", {0x7fffffff, 2}), HasSubstr(kProblem));
  EXPECT_THAT(errorWith("preview", {2, 1, 0}), HasSubstr(kProblem));
  EXPECT_THAT(errorWith("preview", {1, 1, 0}), testing::Not(HasSubstr(kProblem)));
  EXPECT_THAT(errorWith("stringvector", {0x7fffffff, 0}), HasSubstr(kProblem));
  EXPECT_THAT(errorWith("stringvector", {4, 0, 0}), testing::Not(HasSubstr(kProblem)));
  EXPECT_THAT(errorWith("chlist", {}), HasSubstr(kProblem));
  EXPECT_THAT(errorWith("m44f", {1, 2, 3}), HasSubstr(kProblem));
  EXPECT_THAT(errorWith("unknown", {1, 2, 3}), testing::Not(HasSubstr(kProblem)));
}

}  // namespace
}  // namespace quintet::io
