// SPDX-License-Identifier: Apache-2.0
#include "scene/model/limits.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

namespace quintet::scene {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

io::Image makeFloats(std::uint32_t width, std::uint32_t height, std::uint32_t channels, float value) {
  io::Image image = io::makeImage(width, height, channels, io::PixelType::f32, io::ColorEncoding::linear);
  std::ranges::fill(image.samples<float>(), value);
  return image;
}

TEST(SceneLimits, ClampsInfiniteAndHugeTexelsAndReplacesNan) {
  io::Image image = makeFloats(5, 4, 3, 1.0f);
  image.pixel<float>(3, 1)[0] = kInf;
  image.pixel<float>(3, 1)[2] = -kInf;
  image.pixel<float>(0, 2)[1] = kNan;
  image.pixel<float>(4, 3)[1] = 1e20f;
  image.pixel<float>(2, 0)[1] = 65504.0f;  // the largest half float, as of a clipped sun
  image.pixel<float>(2, 0)[0] = kMaxRadiance;
  const std::string repair = repairTexels(image);
  EXPECT_THAT(repair, testing::StartsWith("3 pixels are NaN, infinite or above 1e+12"));
  EXPECT_THAT(repair, testing::EndsWith("the first is at (3, 1), counted from the top left corner"));
  EXPECT_EQ(image.pixel<float>(3, 1)[0], kMaxRadiance);
  EXPECT_EQ(image.pixel<float>(3, 1)[1], 1.0f);
  EXPECT_EQ(image.pixel<float>(3, 1)[2], -kMaxRadiance);
  EXPECT_EQ(image.pixel<float>(0, 2)[1], 0.0f);
  EXPECT_EQ(image.pixel<float>(4, 3)[1], kMaxRadiance);
  EXPECT_EQ(image.pixel<float>(2, 0)[1], 65504.0f);
  EXPECT_EQ(image.pixel<float>(2, 0)[0], kMaxRadiance);
  EXPECT_EQ(repairTexels(image), "");
}

// The first pixel does not depend on the threads that find it.
TEST(SceneLimits, NamesTheFirstPixelOfALargeImage) {
  io::Image image = makeFloats(1024, 512, 4, 0.5f);
  for (std::uint32_t y = 100; y < 512; ++y) image.pixel<float>(17, y)[3] = kNan;
  EXPECT_THAT(repairTexels(image), testing::HasSubstr("412 pixels are"));
  image.pixel<float>(1023, 511)[0] = kInf;
  EXPECT_THAT(repairTexels(image),
              testing::HasSubstr("1 pixel is NaN, infinite or above 1e+12: NaN replaced by 0, other "
                                 "values clamped; it is at (1023, 511)"));
}

TEST(SceneLimits, KeepsImagesOfIntegers) {
  io::Image image = io::makeImage(2, 2, 3, io::PixelType::u16, io::ColorEncoding::linear);
  std::ranges::fill(image.samples<std::uint16_t>(), std::uint16_t{65535});
  EXPECT_EQ(repairTexels(image), "");
}

}  // namespace
}  // namespace quintet::scene
