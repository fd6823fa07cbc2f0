// SPDX-License-Identifier: Apache-2.0
#include "io/jpeg_encoder.h"

#include <cstdint>

#include <gmock/gmock.h>

#include "base/error.h"
#include "io/codec.h"

namespace quintet::io {
namespace {

// A smooth image, which JPEG stores with small errors.
Image gradient(std::uint32_t channels) {
  Image image = makeImage(64, 40, channels, PixelType::u8, ColorEncoding::sRgb);
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = 0; x < image.width; ++x)
      for (std::uint32_t c = 0; c < channels; ++c)
        image.pixel<std::uint8_t>(x, y)[c] = static_cast<std::uint8_t>(c == 3 ? 128 : 2 * x + (c + 1) * y);
  return image;
}

TEST(JpegEncoder, StoresColorsAndGray) {
  for (const std::uint32_t channels : {1u, 2u, 3u, 4u}) {
    const Image image = gradient(channels);
    const Image decoded = decodeImage(encodeJpeg(image, 95), "a.jpg");
    ASSERT_EQ(decoded.width, 64u);
    ASSERT_EQ(decoded.height, 40u);
    ASSERT_EQ(decoded.channels, image.colorChannels());
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x)
        for (std::uint32_t c = 0; c < decoded.channels; ++c)
          EXPECT_NEAR(decoded.pixel<std::uint8_t>(x, y)[c], image.pixel<std::uint8_t>(x, y)[c], 12) << x << ',' << y;
  }
}

TEST(JpegEncoder, IsSmallerAtALowerQuality) {
  EXPECT_LT(encodeJpeg(gradient(3), 30).size(), encodeJpeg(gradient(3), 95).size());
}

TEST(JpegEncoder, RejectsOtherImages) {
  EXPECT_THROW(encodeJpeg(Image(), 80), UsageError);
  EXPECT_THROW(encodeJpeg(makeImage(2, 2, 3, PixelType::f32, ColorEncoding::linear), 80), UsageError);
}

}  // namespace
}  // namespace quintet::io
