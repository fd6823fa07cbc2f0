// SPDX-License-Identifier: Apache-2.0
// `compare`: measures, images and exit status.
#include <gmock/gmock.h>

#include <array>

#include "fixtures.h"
#include "io/codec.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

class Compare : public CliTest {
 protected:
  Compare() {
    io::Image image = testImage(32, 16);
    write(folder_ / "a.png", io::encodePng(image));
    for (auto& sample : image.samples<std::uint8_t>())
      sample = static_cast<std::uint8_t>(sample < 128 ? sample + 4 : sample - 4);
    write(folder_ / "b.png", io::encodePng(image));
    write(folder_ / "big.png", io::encodePng(testImage(64, 32)));
  }
};

TEST_F(Compare, EqualImages) {
  const RunResult result = quintet({"compare", "a.png", "a.png", "--max", "0"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  for (const char* name : {"mae8", "rmse", "relmse", "psnr", "flip"}) EXPECT_THAT(result.out, HasSubstr(name));
  const auto json = nlohmann::json::parse(quintet({"compare", "a.png", "a.png", "--json"}).out);
  EXPECT_EQ(json["mae8"], 0.0);
  EXPECT_TRUE(json["psnr"].is_null());
  EXPECT_EQ(quintet({"compare", "a.png", "a.png", "--metric", "psnr", "--max", "90"}).status, 0);
}

TEST_F(Compare, DifferentImages) {
  const auto json = nlohmann::json::parse(quintet({"compare", "a.png", "b.png", "--json"}).out);
  EXPECT_EQ(json["mae8"], 4.0);
  EXPECT_EQ(json["max8"], 4.0);
  EXPECT_NEAR(json["psnr"].get<double>(), 36.0896, 1e-3);  // 20 log10(255 / 4)
  EXPECT_EQ(quintet({"compare", "a.png", "b.png", "--max", "4"}).status, 0);
  const RunResult exceeded = quintet({"compare", "a.png", "b.png", "--max", "3.5"});
  EXPECT_EQ(exceeded.status, 1);
  EXPECT_THAT(exceeded.err, ::testing::ContainsRegex("a\\.png and b\\.png: mae8 4 .*3\\.5\n"));
  EXPECT_EQ(quintet({"compare", "a.png", "b.png", "--metric", "psnr", "--max", "40"}).status, 1);
  EXPECT_EQ(quintet({"compare", "a.png", "b.png", "--metric", "psnr", "--max", "30"}).status, 0);
}

TEST_F(Compare, DifferentSizes) {
  expectError(quintet({"compare", "a.png", "big.png"}), 2, {"32", "64"});
  const RunResult result = quintet({"compare", "a.png", "big.png", "--resize", "--json"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(result.out)["size"], nlohmann::json({32, 16}));
}

TEST_F(Compare, WritesImagesOfTheDifference) {
  const RunResult result = quintet({"compare", "a.png", "b.png", "-o", "diff.png", "--side-by-side", "all.png"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(readImage("diff.png").width, 32u);
  EXPECT_EQ(readImage("all.png").width, 3 * 32u + 8u);
  EXPECT_EQ(readImage("all.png").height, 16u);
}

// The left half is equal; the right half is black in one image and white in the other.
TEST_F(Compare, DifferenceImagesShowWhereTheImagesDiffer) {
  io::Image image = io::makeImage(64, 16, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  const auto fill = [&](std::uint8_t left, std::uint8_t right) {
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x)
        for (auto& sample : image.pixel<std::uint8_t>(x, y)) sample = x < 32 ? left : right;
  };
  fill(90, 0);
  write(folder_ / "dark.png", io::encodePng(image));
  fill(90, 255);
  write(folder_ / "light.png", io::encodePng(image));
  const RunResult result =
      quintet({"compare", "dark.png", "light.png", "-o", "where.png", "--side-by-side", "both.png"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto color = [](const io::Image& from, std::uint32_t x) {
    const auto p = from.pixel<std::uint8_t>(x, 8);
    return std::array<int, 3>{p[0], p[1], p[2]};
  };
  const io::Image where = readImage("where.png"), both = readImage("both.png");
  EXPECT_EQ(color(where, 4), (std::array<int, 3>{0, 0, 0}));
  const auto different = color(where, 60);
  EXPECT_GT(different[0], 240);
  EXPECT_GT(different[1], 200);
  EXPECT_LT(different[2], different[1]);
  // Both images and the error, with gaps of four pixels.
  EXPECT_EQ(color(both, 10), (std::array<int, 3>{90, 90, 90}));
  EXPECT_EQ(color(both, 50), (std::array<int, 3>{0, 0, 0}));
  EXPECT_EQ(color(both, 68 + 10), (std::array<int, 3>{90, 90, 90}));
  EXPECT_EQ(color(both, 68 + 50), (std::array<int, 3>{255, 255, 255}));
  EXPECT_EQ(color(both, 136 + 4), color(where, 4));
  EXPECT_EQ(color(both, 136 + 60), different);
}

TEST_F(Compare, MissingImage) { expectError(quintet({"compare", "a.png", "c.png"}), 1, {"c.png", "No such file"}); }

TEST_F(Compare, GammaOfTheReference) {
  // 118 with the sRGB curve and 117 with the power 2.2 both stand for a linear value of 0.181.
  io::Image image = io::makeImage(8, 8, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  for (auto& sample : image.samples<std::uint8_t>()) sample = 118;
  write(folder_ / "srgb.png", io::encodePng(image));
  for (auto& sample : image.samples<std::uint8_t>()) sample = 117;
  write(folder_ / "power.png", io::encodePng(image));
  const auto json =
      nlohmann::json::parse(quintet({"compare", "srgb.png", "power.png", "--gamma-b", "2.2", "--json"}).out);
  EXPECT_LE(json["mae8"], 0.0);
}

}  // namespace
}  // namespace quintet::test
