// SPDX-License-Identifier: Apache-2.0
#include "io/compare.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/color.h"
#include "io/samples.h"

namespace quintet::io {
namespace {

using test::makeGradient;

Image constant(std::uint32_t width, std::uint32_t height, const std::vector<float>& pixel) {
  Image image =
      makeImage(width, height, static_cast<std::uint32_t>(pixel.size()), PixelType::f32, ColorEncoding::linear);
  for (std::size_t i = 0; i < image.sampleCount(); ++i) image.samples<float>()[i] = pixel[i % pixel.size()];
  return image;
}
Image black(std::uint32_t side) { return constant(side, side, {0, 0, 0}); }
Image white(std::uint32_t side) { return constant(side, side, {1, 1, 1}); }
float flipAt(const Image& a, const Image& b, std::uint32_t x, std::uint32_t y) {
  return flipMap(a, b).pixel<float>(x, y)[0];
}

TEST(CompareTest, ReportsNoDifferenceForEqualImages) {
  for (const PixelType type : {PixelType::u8, PixelType::u16, PixelType::f32}) {
    const Image image = makeGradient(40, 30, 4, type);
    const Comparison c = compareImages(image, image);
    EXPECT_EQ(c.rmse, 0.0);
    EXPECT_EQ(c.relMse, 0.0);
    EXPECT_EQ(c.mae8, 0.0);
    EXPECT_EQ(c.max8, 0.0);
    EXPECT_EQ(c.psnr, std::numeric_limits<double>::infinity());
    EXPECT_EQ(c.flip, 0.0);
    EXPECT_EQ(c.alphaMae8, 0.0);
    EXPECT_EQ(c.nonFinitePixels, 0u);
  }
}

TEST(CompareTest, MeasuresAKnownOffset) {
  // Linear 0.5 and 0.4 are the bytes 188 and 170.
  const Comparison c = compareImages(constant(8, 4, {0.5f, 0.5f, 0.5f}), constant(8, 4, {0.4f, 0.4f, 0.4f}));
  EXPECT_NEAR(c.rmse, 0.1, 1e-6);
  EXPECT_NEAR(c.relMse, 0.01 / (0.16 + 0.01), 1e-6);
  EXPECT_EQ(c.mae8, 18.0);
  EXPECT_EQ(c.max8, 18.0);
  EXPECT_NEAR(c.psnr, 20.0 * std::log10(255.0 / 18.0), 1e-9);
}

TEST(CompareTest, AveragesOverPixelsAndChannels) {
  // One sample of 4 · 3 differs by 0.5 in linear light (bytes 0 and 188).
  Image a = black(2);
  a.samples<float>()[5] = 0.5f;
  const Comparison c = compareImages(a, black(2));
  EXPECT_NEAR(c.rmse, std::sqrt(0.25 / 12.0), 1e-6);
  EXPECT_NEAR(c.relMse, 0.25 / 0.01 / 12.0, 1e-4);
  EXPECT_NEAR(c.mae8, 188.0 / 12.0, 1e-9);
  EXPECT_EQ(c.max8, 188.0);
  EXPECT_NEAR(c.psnr, 10.0 * std::log10(255.0 * 255.0 / (188.0 * 188.0 / 12.0)), 1e-9);
  // The reference is the second image.
  EXPECT_NEAR(compareImages(black(2), a).relMse, 0.25 / 0.26 / 12.0, 1e-6);
}

TEST(CompareTest, ConvertsEncodingsAndChannels) {
  Image bytes = makeImage(3, 3, 1, PixelType::u8, ColorEncoding::sRgb);
  std::ranges::fill(bytes.samples<std::uint8_t>(), std::uint8_t{188});
  const float linear = linearFromSrgb(188.0f / 255.0f);
  const Comparison c = compareImages(bytes, constant(3, 3, {linear, linear, linear, 1.0f}));
  EXPECT_LT(c.rmse, 1e-6);
  EXPECT_EQ(c.max8, 0.0);
  EXPECT_LT(c.flip, 1e-3);
}

TEST(CompareTest, ComparesAlphaAsCoverageOverBlack) {
  const Image half = constant(4, 4, {1.0f, 1.0f, 1.0f, 0.5f});
  Image same = constant(4, 4, {0.5f, 0.5f, 0.5f, 0.5f});
  same.premultiplied = true;
  EXPECT_EQ(compareImages(half, same).rmse, 0.0);
  const Comparison c = compareImages(half, constant(4, 4, {0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(c.rmse, 0.0);
  EXPECT_EQ(c.max8, 0.0);
  EXPECT_EQ(c.alphaMae8, 255.0 - 128.0);
  // Color with alpha 0 is ignored.
  EXPECT_EQ(compareImages(constant(4, 4, {1.0f, 0.5f, 0.0f, 0.0f}), constant(4, 4, {0.0f, 0.0f, 0.0f, 0.0f})).max8,
            0.0);
}

TEST(CompareTest, CountsNonFinitePixels) {
  Image a = constant(4, 4, {0.5f, 0.5f, 0.5f});
  Image b = a;
  a.samples<float>()[0] = std::numeric_limits<float>::quiet_NaN();
  a.samples<float>()[4] = std::numeric_limits<float>::infinity();
  const Comparison c = compareImages(a, b);
  EXPECT_EQ(c.nonFinitePixels, 2u);
  EXPECT_EQ(c.rmse, 0.0);
  EXPECT_EQ(c.max8, 188.0);  // NaN becomes black
  EXPECT_TRUE(std::isfinite(c.flip));
  b.samples<float>()[47] = 0.25f;  // the means are those of the 14 other pixels
  const Comparison different = compareImages(a, b);
  EXPECT_NEAR(different.rmse, 0.25 / std::sqrt(42.0), 1e-7);
  EXPECT_NEAR(different.relMse, 0.0625 / (0.0625 + 0.01) / 42.0, 1e-7);
}

TEST(CompareTest, RejectsDifferentSizesAndInvalidDistances) {
  EXPECT_THROW(compareImages(black(3), black(4)), UsageError);
  EXPECT_THROW(compareImages(Image{}, Image{}), UsageError);
  EXPECT_THROW(flipMap(black(3), black(4)), UsageError);
  EXPECT_THROW(flipMap(black(3), black(3), 0.0f), UsageError);
  EXPECT_THROW(flipMap(black(3), black(3), NAN), UsageError);
}

// The expected values of the next tests come from an independent program that evaluates the equations of the paper with
// two-dimensional kernels in double precision.
TEST(FlipTest, MatchesReferenceValuesOfConstantColors) {
  EXPECT_NEAR(flipAt(black(8), white(8), 4, 4), 0.9673798f, 1e-4f);
  EXPECT_NEAR(flipAt(constant(8, 8, {0, 1, 0}), constant(8, 8, {0, 0, 1}), 4, 4), 1.0f, 1e-5f);
  const float a = linearFromSrgb(0.5f);
  const float b = linearFromSrgb(0.6f);
  EXPECT_NEAR(flipAt(constant(8, 8, {a, a, a}), constant(8, 8, {b, b, b}), 4, 4), 0.2850130f, 1e-4f);
  EXPECT_NEAR(flipAt(constant(8, 8, {1, 0, 0}), constant(8, 8, {0.9f, 0, 0}), 4, 4), 0.2183848f, 1e-4f);
}

TEST(FlipTest, MatchesReferenceValuesOfDotsAndEdges) {
  Image dot = black(41);
  std::ranges::fill(dot.pixel<float>(20, 20), 1.0f);
  const Image map = flipMap(dot, black(41));
  EXPECT_NEAR(map.pixel<float>(20, 20)[0], 0.8650487f, 2e-4f);
  EXPECT_NEAR(map.pixel<float>(25, 20)[0], 0.0012555f, 2e-4f);
  EXPECT_NEAR(compareImages(dot, black(41)).flip, 0.0085111, 1e-4);

  Image edge = black(41);
  for (std::uint32_t y = 0; y < 41; ++y)
    for (std::uint32_t x = 20; x < 41; ++x) std::ranges::fill(edge.pixel<float>(x, y), 1.0f);
  const float gray = linearFromSrgb(0.5f);
  const Image plain = constant(41, 41, {gray, gray, gray});
  EXPECT_NEAR(flipAt(edge, plain, 20, 20), 0.9380088f, 2e-4f);
  EXPECT_NEAR(flipAt(edge, plain, 0, 20), 0.9314961f, 2e-4f);
  EXPECT_NEAR(compareImages(edge, plain).flip, 0.9021173, 2e-4);
}

TEST(FlipTest, IsSymmetricAndInRange) {
  const Image a = makeGradient(50, 40, 3, PixelType::u8);
  const Image b = makeGradient(50, 40, 3, PixelType::f32);
  const Image ab = flipMap(a, b);
  EXPECT_EQ(ab.data, flipMap(b, a).data);
  for (const float value : ab.samples<float>()) {
    EXPECT_GE(value, 0.0f);
    EXPECT_LE(value, 1.0f);
  }
}

TEST(FlipTest, IncreasesWithTheError) {
  const Image base = makeGradient(40, 40, 3, PixelType::u8);
  double before = 0.0;
  for (const int step : {2, 8, 32}) {
    Image changed = base;
    for (std::size_t i = 0; i < changed.sampleCount(); i += 7)
      changed.samples<std::uint8_t>()[i] =
          static_cast<std::uint8_t>(std::min(255, changed.samples<std::uint8_t>()[i] + step));
    const double flip = compareImages(changed, base).flip;
    EXPECT_GT(flip, before);
    before = flip;
  }
}

// From a distance a checkerboard looks gray.
TEST(FlipTest, IgnoresFineDetailAtADistance) {
  Image board = black(40);
  for (std::uint32_t y = 0; y < 40; ++y)
    for (std::uint32_t x = 0; x < 40; ++x) std::ranges::fill(board.pixel<float>(x, y), (x + y) % 2 == 0 ? 0.6f : 0.4f);
  const Image gray = constant(40, 40, {0.5f, 0.5f, 0.5f});
  EXPECT_GT(compareImages(board, gray, 5.0f).flip, 0.2);
  EXPECT_LT(compareImages(board, gray, 100.0f).flip, 0.02);
}

TEST(FlipTest, SupportsSmallImages) {
  EXPECT_NEAR(flipAt(constant(1, 1, {0, 0, 0}), constant(1, 1, {1, 1, 1}), 0, 0), 0.9673798f, 1e-4f);
  EXPECT_EQ(flipMap(constant(3, 1, {1, 0, 0}), constant(3, 1, {1, 0, 0}), 1.0f).pixelCount(), 3u);
}

TEST(ColorMapTest, IncreasesLightness) {
  Image ramp = makeImage(256, 1, 1, PixelType::f32, ColorEncoding::linear);
  for (std::size_t i = 0; i < 256; ++i) ramp.samples<float>()[i] = static_cast<float>(i) / 255.0f;
  const Image colors = colorMap(ramp);
  EXPECT_EQ(colors.channels, 3u);
  const Image gray = toChannels(toFloat(colors), 1);
  for (std::size_t i = 1; i < 256; ++i) EXPECT_GE(gray.samples<float>()[i] + 1e-4f, gray.samples<float>()[i - 1]) << i;
  EXPECT_LT(gray.samples<float>()[0], 0.001f);
  EXPECT_GT(gray.samples<float>()[255], 0.85f);
}

}  // namespace
}  // namespace quintet::io
