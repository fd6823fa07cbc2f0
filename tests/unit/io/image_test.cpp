// SPDX-License-Identifier: Apache-2.0
#include "io/image.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "io/color.h"
#include "io/samples.h"

namespace quintet::io {
namespace {

using testing::ElementsAre;
using testing::FloatNear;
using testing::Pointwise;

Image floats(std::uint32_t width, std::uint32_t height, std::uint32_t channels, const std::vector<float>& values) {
  Image image = makeImage(width, height, channels, PixelType::f32, ColorEncoding::linear);
  std::ranges::copy(values, image.samples<float>().begin());
  return image;
}

double meanOf(const Image& image) {
  const auto samples = image.samples<float>();
  return std::accumulate(samples.begin(), samples.end(), 0.0) / static_cast<double>(samples.size());
}

TEST(ColorTest, MatchesPublishedValues) {
  EXPECT_FLOAT_EQ(linearFromSrgb(0.0f), 0.0f);
  EXPECT_FLOAT_EQ(linearFromSrgb(1.0f), 1.0f);
  EXPECT_NEAR(linearFromSrgb(0.5f), 0.21404114f, 1e-7f);
  EXPECT_NEAR(linearFromSrgb(0.04045f), 0.0031308f, 1e-7f);
  EXPECT_NEAR(srgbFromLinear(0.18f), 0.46135613f, 1e-7f);
  EXPECT_NEAR(linearFromSrgb(188.0f / 255.0f), 0.5028865f, 1e-6f);
}

TEST(ColorTest, HasInverseMonotonicFunctions) {
  float before = -1.0f;
  for (int i = 0; i <= 1000; ++i) {
    const float value = static_cast<float>(i) / 1000.0f;
    EXPECT_NEAR(linearFromSrgb(srgbFromLinear(value)), value, 1e-6f);
    EXPECT_GT(srgbFromLinear(value), before);
    before = srgbFromLinear(value);
  }
  for (int i = 0; i < 256; ++i)
    EXPECT_EQ(byteFromUnit(srgbFromLinear(linearFromSrgb(static_cast<float>(i) / 255.0f))), i);
}

TEST(ColorTest, RoundsAndClampsBytes) {
  EXPECT_EQ(byteFromUnit(-1.0f), 0);
  EXPECT_EQ(byteFromUnit(2.0f), 255);
  EXPECT_EQ(byteFromUnit(NAN), 0);
  EXPECT_EQ(byteFromUnit(0.5f), 128);
  EXPECT_EQ(byteFromUnit(1.4f / 255.0f), 1);
}

TEST(ImageTest, ComputesSizes) {
  Image image = makeImage(5, 3, 4, PixelType::u16, ColorEncoding::linear);
  EXPECT_EQ(image.rowBytes(), 40u);
  EXPECT_EQ(image.data.size(), 120u);
  EXPECT_EQ(image.sampleCount(), 60u);
  image.pixel<std::uint16_t>(4, 2)[3] = 7;
  EXPECT_EQ(image.samples<std::uint16_t>()[59], 7);
  EXPECT_TRUE(image.hasAlpha());
  EXPECT_TRUE(Image{}.empty());
}

TEST(ImageTest, DecodesSrgbExceptAlpha) {
  Image image = makeImage(1, 1, 4, PixelType::u8, ColorEncoding::sRgb);
  std::ranges::copy(std::array<std::uint8_t, 4>{0, 188, 255, 188}, image.samples<std::uint8_t>().begin());
  const std::vector<float> decoded{0.0f, linearFromSrgb(188.0f / 255.0f), 1.0f, 188.0f / 255.0f};
  EXPECT_THAT(toFloat(image).samples<float>(), Pointwise(FloatNear(1e-6f), decoded));
  image.encoding = ColorEncoding::linear;
  EXPECT_FLOAT_EQ(toFloat(image).samples<float>()[1], 188.0f / 255.0f);

  Image wide = makeImage(1, 1, 1, PixelType::u16, ColorEncoding::sRgb);
  wide.samples<std::uint16_t>()[0] = 32768;
  EXPECT_NEAR(toFloat(wide).samples<float>()[0], linearFromSrgb(32768.0f / 65535.0f), 1e-6f);
}

TEST(ImageTest, DecodesAPowerExceptAlpha) {
  Image image = makeImage(1, 1, 4, PixelType::u8, ColorEncoding::sRgb);
  std::ranges::copy(std::array<std::uint8_t, 4>{0, 51, 255, 51}, image.samples<std::uint8_t>().begin());
  EXPECT_THAT(decodePower(image, 2.0f).samples<float>(),
              Pointwise(FloatNear(1e-6f), std::vector<float>{0.0f, 0.04f, 1.0f, 0.2f}));
  EXPECT_THAT(decodePower(floats(1, 1, 1, {0.5f}), 2.0f).samples<float>(), ElementsAre(0.5f));
}

TEST(ImageTest, EncodesSrgbWithStraightAlpha) {
  EXPECT_THAT(toSrgb8(floats(1, 1, 3, {-1.0f, 0.21404114f, 7.0f})).samples<std::uint8_t>(), ElementsAre(0, 128, 255));
  Image premultiplied = floats(2, 1, 2, {0.25f, 0.25f, 0.5f, 0.0f});
  premultiplied.premultiplied = true;
  const Image straight = toSrgb8(premultiplied);
  EXPECT_THAT(straight.samples<std::uint8_t>(), ElementsAre(255, 64, 188, 0));
  EXPECT_FALSE(straight.premultiplied);
  const Image bytes = test::makeGradient(9, 9, 4, PixelType::u8);
  EXPECT_EQ(toSrgb8(toFloat(bytes)).data, bytes.data);
}

TEST(ImageTest, ConvertsChannelCounts) {
  const Image rgba = floats(1, 1, 4, {1.0f, 0.5f, 0.25f, 0.75f});
  EXPECT_THAT(toChannels(rgba, 3).samples<float>(), ElementsAre(1.0f, 0.5f, 0.25f));
  const float gray = 0.2126f + 0.5f * 0.7152f + 0.25f * 0.0722f;
  EXPECT_FLOAT_EQ(toChannels(rgba, 1).samples<float>()[0], gray);
  EXPECT_FLOAT_EQ(toChannels(rgba, 2).samples<float>()[1], 0.75f);
  EXPECT_THAT(toChannels(floats(1, 1, 2, {0.5f, 0.25f}), 4).samples<float>(), ElementsAre(0.5f, 0.5f, 0.5f, 0.25f));
  EXPECT_THAT(toChannels(floats(1, 1, 1, {0.5f}), 4).samples<float>(), ElementsAre(0.5f, 0.5f, 0.5f, 1.0f));

  Image bytes = makeImage(1, 1, 3, PixelType::u8, ColorEncoding::sRgb);
  std::ranges::fill(bytes.samples<std::uint8_t>(), std::uint8_t{100});
  EXPECT_THAT(toChannels(bytes, 1).samples<std::uint8_t>(), ElementsAre(100));
  EXPECT_THAT(toChannels(bytes, 4).samples<std::uint8_t>(), ElementsAre(100, 100, 100, 255));
}

TEST(ResizeTest, AveragesAreas) {
  const Image image = floats(4, 2, 1, {1, 2, 3, 4, 5, 6, 7, 8});
  EXPECT_THAT(resizeBox(image, 2, 1).samples<float>(), ElementsAre(3.5f, 5.5f));
  EXPECT_THAT(resizeBox(image, 1, 1).samples<float>(), ElementsAre(4.5f));
  EXPECT_THAT(resizeBox(image, 4, 2).samples<float>(), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  // Three pixels become two; each covers one and a half.
  EXPECT_THAT(resizeBox(floats(3, 1, 1, {3, 6, 9}), 2, 1).samples<float>(),
              ElementsAre(FloatNear(4, 1e-5f), FloatNear(8, 1e-5f)));
  EXPECT_THAT(resizeBox(floats(2, 1, 1, {3, 6}), 4, 1).samples<float>(), ElementsAre(3, 3, 6, 6));
}

TEST(ResizeTest, PreservesTheMean) {
  const Image image = test::makeGradient(97, 61, 3, PixelType::f32);
  for (const auto& [width, height] : {std::pair{13u, 61u}, {50u, 7u}, {200u, 150u}, {96u, 60u}})
    EXPECT_NEAR(meanOf(resizeBox(image, width, height)), meanOf(image), 1e-4) << width;
}

TEST(ResizeTest, WorksInLinearLight) {
  Image image = makeImage(2, 1, 1, PixelType::u8, ColorEncoding::sRgb);
  image.samples<std::uint8_t>()[0] = 255;
  EXPECT_FLOAT_EQ(resizeBox(image, 1, 1).samples<float>()[0], 0.5f);
}

// Compares rows that are written in pieces with an independent loop.
TEST(ResizeTest, ReducesTheImageWithMorePixels) {
  for (const bool swapped : {false, true}) {
    Image large = floats(4, 2, 1, {1, 2, 3, 4, 5, 6, 7, 8}), small = floats(2, 1, 1, {0, 9});
    swapped ? resizeToSmaller(small, large) : resizeToSmaller(large, small);
    EXPECT_THAT(large.samples<float>(), ElementsAre(3.5f, 5.5f));
    EXPECT_THAT(small.samples<float>(), ElementsAre(0, 9));
  }
}

TEST(WriteChannelsTest, WritesRanges) {
  constexpr std::uint32_t kWidth = 5, kHeight = 7;
  for (const std::uint32_t channels : {1u, 2u, 3u, 4u}) {
    Image image = makeImage(kWidth, kHeight, channels, PixelType::u8, ColorEncoding::sRgb);
    for (std::size_t i = 0; i < image.data.size(); ++i)
      image.samples<std::uint8_t>()[i] = static_cast<std::uint8_t>(37 * i + 11);
    std::vector<std::byte> whole(kWidth * kHeight * 4);
    for (std::uint32_t first = 0; first < kHeight; first += 3) {
      const std::uint32_t rows = std::min(3u, kHeight - first);
      writeChannels(image, 4, first,
                    std::span(whole).subspan(std::size_t{4} * kWidth * first, std::size_t{4} * kWidth * rows));
    }
    const bool gray = channels <= 2, alpha = channels % 2 == 0;
    for (std::uint32_t p = 0; p < kWidth * kHeight; ++p) {
      const auto in = [&](std::uint32_t c) { return image.data[std::size_t{p} * channels + c]; };
      for (std::uint32_t c = 0; c < 3; ++c) EXPECT_EQ(whole[4 * p + c], in(gray ? 0 : c)) << channels << ' ' << p;
      EXPECT_EQ(whole[4 * p + 3], alpha ? in(channels - 1) : std::byte{255}) << channels << ' ' << p;
    }
    EXPECT_EQ(toChannels(image, 4).data, whole);
  }
}

TEST(ResizeTest, IgnoresColorsOfTransparentPixels) {
  const Image image = floats(2, 1, 2, {1.0f, 1.0f, 9.0f, 0.0f});
  EXPECT_THAT(resizeBox(image, 1, 1).samples<float>(), ElementsAre(1.0f, 0.5f));
  Image premultiplied = floats(2, 1, 2, {1.0f, 1.0f, 9.0f, 0.0f});
  premultiplied.premultiplied = true;
  EXPECT_THAT(resizeBox(premultiplied, 1, 1).samples<float>(), ElementsAre(5.0f, 0.5f));
}

TEST(ResizeTest, RejectsEmptyImages) {
  EXPECT_THROW(resizeBox(floats(1, 1, 1, {1}), 0, 1), UsageError);
  EXPECT_THROW(resizeBox(Image{}, 1, 1), UsageError);
}

}  // namespace
}  // namespace quintet::io
