// SPDX-License-Identifier: Apache-2.0
#include "lab/pixel_mean.h"

#include <gmock/gmock.h>

#include "base/error.h"

namespace quintet::lab {
namespace {

TEST(PixelMean, AveragesTheBlockOnly) {
  io::Image image = io::makeImage(4, 3, 2, io::PixelType::f32, io::ColorEncoding::linear);
  for (std::uint32_t y = 0; y < 3; ++y)
    for (std::uint32_t x = 0; x < 4; ++x) {
      image.pixel<float>(x, y)[0] = static_cast<float>(x);
      image.pixel<float>(x, y)[1] = static_cast<float>(10 * y);
    }
  EXPECT_THAT(pixelMean(image, {1, 2}, {1, 1}), ::testing::ElementsAre(1.0f, 20.0f));
  EXPECT_THAT(pixelMean(image, {1, 1}, {3, 2}), ::testing::ElementsAre(2.0f, 15.0f));
  EXPECT_THAT(pixelMean(image, {0, 0}, {4, 3}), ::testing::ElementsAre(1.5f, 10.0f));
  EXPECT_THROW(pixelMean(image, {1, 1}, {4, 1}), UsageError);
  EXPECT_THROW(pixelMean(image, {4, 0}, {1, 1}), UsageError);
  EXPECT_THROW(pixelMean(image, {0, 0}, {0, 1}), UsageError);
}

}  // namespace
}  // namespace quintet::lab
