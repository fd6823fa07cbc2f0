// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "io/codec.h"
#include "io/samples.h"

namespace quintet::io {
namespace {

using test::bytesOf;
using test::makeGradient;
using testing::ElementsAre;
using testing::HasSubstr;

std::string hdrError(const std::string& text) {
  try {
    decodeImage(bytesOf(text), "a.hdr");
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

// Returns the red samples of an image whose red mantissas are `reds`. With the exponent 128 + 8 the value is the
// mantissa.
std::vector<float> redsOf(const std::string& header, const std::string& reds) {
  std::string text = header;
  for (const char red : reds) text += {red, 0, 0, static_cast<char>(136)};
  const Image image = decodeImage(bytesOf(text), "a.hdr");
  std::vector<float> values;
  for (std::size_t i = 0; i < image.sampleCount(); i += 3) values.push_back(image.samples<float>()[i]);
  return values;
}

TEST(HdrTest, RoundTripsWithinItsPrecision) {
  for (const std::uint32_t width : {3u, 8u, 200u}) {
    const Image image = makeGradient(width, 11, 3, PixelType::f32);
    const Image back = decodeImage(encodeHdr(image), "a.hdr");
    ASSERT_EQ(back.width, width);
    ASSERT_EQ(back.channels, 3u);
    EXPECT_EQ(back.encoding, ColorEncoding::linear);
    for (std::uint32_t y = 0; y < image.height; ++y) {
      for (std::uint32_t x = 0; x < width; ++x) {
        const auto a = image.pixel<float>(x, y);
        const auto b = back.pixel<float>(x, y);
        // Half a step of an 8 bit mantissa of at least 128.
        const float tolerance = std::max({a[0], a[1], a[2]}) / 256.0f;
        for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(a[c], b[c], tolerance);
      }
    }
  }
}

TEST(HdrTest, EncodesRunsAndExtremeValues) {
  Image image = makeImage(300, 1, 3, PixelType::f32, ColorEncoding::linear);
  for (std::size_t i = 0; i < 600; ++i) image.samples<float>()[i] = 2.0f;  // 200 equal pixels, then black
  const float inf = std::numeric_limits<float>::infinity();
  const std::array<float, 9> last{inf, 1.0f, -1.0f, NAN, 1e-45f, 0.0f, 1.999f, 0.5f, 0.003f};
  std::ranges::copy(last, image.samples<float>().end() - 9);
  const auto bytes = encodeHdr(image);
  EXPECT_LT(bytes.size(), 200u);
  const Image back = decodeImage(bytes, "a.hdr");
  EXPECT_EQ(back.pixel<float>(0, 0)[0], 2.0f);
  EXPECT_EQ(back.pixel<float>(199, 0)[2], 2.0f);
  EXPECT_EQ(back.pixel<float>(200, 0)[0], 0.0f);
  EXPECT_FLOAT_EQ(back.pixel<float>(297, 0)[0], 0x1.fep+126f);
  EXPECT_EQ(back.pixel<float>(297, 0)[2], 0.0f);
  EXPECT_EQ(back.pixel<float>(298, 0)[0], 0.0f);
  EXPECT_EQ(back.pixel<float>(298, 0)[1], 0.0f);
  EXPECT_EQ(back.pixel<float>(299, 0)[0], 2.0f);  // rounds up to the next power of two
  EXPECT_FLOAT_EQ(back.pixel<float>(299, 0)[1], 0.5f);
}

TEST(HdrTest, ReadsEveryOrientation) {
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  // The decoded image is 1 2 3 / 4 5 6.
  const auto shown = ElementsAre(1, 2, 3, 4, 5, 6);
  EXPECT_THAT(redsOf(header + "-Y 2 +X 3\n", "\1\2\3\4\5\6"), shown);
  EXPECT_THAT(redsOf(header + "-Y 2 -X 3\n", "\3\2\1\6\5\4"), shown);
  EXPECT_THAT(redsOf(header + "+Y 2 +X 3\n", "\4\5\6\1\2\3"), shown);
  EXPECT_THAT(redsOf(header + "+Y 2 -X 3\n", "\6\5\4\3\2\1"), shown);
  EXPECT_THAT(redsOf(header + "+X 3 -Y 2\n", "\1\4\2\5\3\6"), shown);
  EXPECT_THAT(redsOf(header + "-X 3 +Y 2\n", "\6\3\5\2\4\1"), shown);
}

TEST(HdrTest, ReadsOldRuns) {
  std::string text = "#?RADIANCE\n\n-Y 1 +X 300\n";
  text += std::string("\5\0\0\x88", 4) + "\1\1\1\x2b" + "\1\1\1\1";  // 1 + 43 + 256 pixels
  const Image image = decodeImage(bytesOf(text), "a.hdr");
  for (std::uint32_t x = 0; x < 300; ++x) ASSERT_EQ(image.pixel<float>(x, 0)[0], 5.0f) << x;
}

TEST(HdrTest, DividesByExposure) {
  EXPECT_THAT(redsOf("#?RADIANCE\nEXPOSURE=2\nEXPOSURE= 4.0\n\n-Y 1 +X 2\n", "\x8\x10"), ElementsAre(1, 2));
  EXPECT_THAT(hdrError("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 2\n"), HasSubstr("EXPOSURE"));
}

TEST(HdrTest, ReportsProblemsWithTheirOffset) {
  const std::string header = "#?RADIANCE\n\n-Y 1 +X 9\n";
  EXPECT_THAT(hdrError("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 9\n"),
              HasSubstr("a.hdr: byte 11: Radiance HDR with FORMAT"));
  for (const char* line : {"-Y 1", "-Y 1 +Y 2", "-Y 1 +X", "-Y one +X 2", "-Y 1 +X 2x", "Y 1 X 2", "-Y -1 +X 2"})
    EXPECT_THAT(hdrError(std::string("#?RADIANCE\n\n") + line + "\n"), HasSubstr("resolution")) << line;
  EXPECT_THAT(hdrError("#?RADIANCE\n"), HasSubstr("header ends early"));
  EXPECT_THAT(hdrError("#?RADIANCE\n\n-Y 0 +X 9\n"), HasSubstr("no pixels"));
  EXPECT_THAT(hdrError(header), HasSubstr("byte 22: Radiance HDR data ends early"));
  EXPECT_THAT(hdrError(header + std::string("\2\2\0\x8", 4)), HasSubstr("wrong width"));
  EXPECT_THAT(hdrError(header + std::string("\2\2\0\x9\x8a\1", 6)), HasSubstr("a run exceeds its scan line"));
  EXPECT_THAT(hdrError(header + std::string("\2\2\0\x9\0\1", 6)), HasSubstr("a run exceeds its scan line"));
  EXPECT_THAT(hdrError(header + "\1\1\1\1"), HasSubstr("a run exceeds its scan line"));
  EXPECT_THAT(hdrError(header + "\5\5\5\5\1\1\1\x9"), HasSubstr("a run exceeds its scan line"));
}

}  // namespace
}  // namespace quintet::io
