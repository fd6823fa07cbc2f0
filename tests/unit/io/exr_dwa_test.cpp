// SPDX-License-Identifier: Apache-2.0
// The lossy compressions of OpenEXR near the largest half float: no finite value becomes infinite.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "io/exr/dwa_limits.h"
#include "io/exr/exr.h"

namespace quintet::io {
namespace {

constexpr std::uint32_t kWidth = 70, kHeight = 45;

struct Case {
  ExrCompression compression;
  std::optional<float> level;
  ExrType type;
  std::uint32_t tileSize;
};

std::vector<Case> allCases() {
  std::vector<Case> cases;
  for (const ExrCompression compression : {ExrCompression::dwaa, ExrCompression::dwab})
    for (const std::optional<float> level : {std::optional<float>(), {0.0f}, {300.0f}, {2000.0f}, {10000.0f}})
      for (const ExrType type : {ExrType::half, ExrType::f32})
        for (const std::uint32_t tile : {0u, 16u, 33u}) cases.push_back({compression, level, type, tile});
  return cases;
}

// R, G and B of the image and of a layer, and an alpha channel. The left half has noise near the largest half float.
ExrImage brightImage(ExrType type) {
  std::minstd_rand random(7);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  ExrImage image{kWidth, kHeight, {}};
  for (const char* name : {"R", "G", "B", "A", "lights.R", "lights.G", "lights.B"}) {
    ExrChannel channel{name, type, std::vector<float>(std::size_t{kWidth} * kHeight)};
    for (std::size_t i = 0; i < channel.samples.size(); ++i) {
      const float u = uniform(random);
      channel.samples[i] = i % kWidth < kWidth / 2 ? 65504.0f * std::exp(-u * u * 8.0f) : u;
    }
    channel.samples[3] = 1e30f;
    channel.samples[kWidth + 5] = -70000.0f;
    channel.samples[2 * kWidth + 9] = std::numeric_limits<float>::quiet_NaN();
    channel.samples[3 * kWidth + 9] = std::numeric_limits<float>::infinity();
    channel.samples[20 * kWidth + kWidth - 1] = 65504.0f;  // alone among small values
    image.channels.push_back(std::move(channel));
  }
  return image;
}

const ExrChannel& channelNamed(const ExrImage& image, const std::string& name) {
  return *std::ranges::find(image.channels, name, &ExrChannel::name);
}

TEST(ExrDwaTest, WritesNoInfinityForFiniteValues) {
  for (const Case& c : allCases()) {
    const ExrImage image = brightImage(c.type);
    const ExrImage back = decodeExr(encodeExr(image, {c.compression, c.level, c.tileSize}), "a.exr");
    std::size_t wrong = 0;
    for (const ExrChannel& channel : image.channels)
      for (std::size_t i = 0; i < channel.samples.size(); ++i)
        wrong += std::isfinite(channel.samples[i]) && !std::isfinite(channelNamed(back, channel.name).samples[i]) &&
                 (channel.name != "A" || c.type == ExrType::half);
    EXPECT_EQ(wrong, 0u) << exrCompressionNames()[static_cast<std::size_t>(c.compression)] << ":"
                         << c.level.value_or(-1.0f) << " tiles " << c.tileSize << " type " << static_cast<int>(c.type);
  }
}

// Values that are not in a block with an infinite value keep the precision of the compression.
TEST(ExrDwaTest, KeepsTheValuesOfOtherBlocks) {
  const ExrImage image = brightImage(ExrType::half);
  for (const ExrCompression compression : {ExrCompression::dwaa, ExrCompression::dwab}) {
    const std::vector<std::byte> bytes = encodeExr(image, {compression});
    EXPECT_EQ(inspectExr(bytes, "a")[0].compression, exrCompressionNames()[static_cast<std::size_t>(compression)]);
    const ExrImage back = decodeExr(bytes, "a.exr");
    const std::vector<float>&before = channelNamed(image, "G").samples, &after = channelNamed(back, "G").samples;
    for (std::size_t y = 0; y < 16; ++y)
      for (std::size_t x = kWidth / 2 + 8; x < kWidth - 16; ++x)
        EXPECT_NEAR(after[y * kWidth + x], before[y * kWidth + x], 0.05f);
    EXPECT_GT(after[20 * kWidth + kWidth - 1], 10000.0f);
  }
}

// A quantization that can raise any value to infinity is replaced by a compression without loss.
TEST(ExrDwaTest, UsesZipWhereNoLimitIsLowEnough) {
  ExrImage image = brightImage(ExrType::half);
  const std::vector<std::byte> bytes = encodeExr(image, {ExrCompression::dwaa, 10000.0f});
  const std::string used = inspectExr(bytes, "a")[0].compression;
  if (used == "zip")
    EXPECT_EQ(channelNamed(decodeExr(bytes, "a.exr"), "R").samples[3], 65504.0f);
  else
    EXPECT_EQ(used, "dwaa");
}

TEST(ExrDwaTest, DecodesTheFileOnlyForLargeValues) {
  ExrImage image{8,
                 8,
                 {{"R", ExrType::half, std::vector<float>(64, 1000.0f)},
                  {"depth.Z", ExrType::f32, std::vector<float>(64, 1e9f), true}}};
  const std::vector<const ExrChannel*> channels{&image.channels[0]};
  EXPECT_FALSE(DwaLimits(image, channels, 0).canOverflow(45.0f));
  EXPECT_TRUE(DwaLimits(image, channels, 0).canOverflow(5000.0f));
  image.channels[0].samples[63] = -2000.0f;
  EXPECT_TRUE(DwaLimits(image, channels, 0).canOverflow(45.0f));
}

// The file is encoded without loss. The pixel `broken` is infinite in it, so the limit is half of the largest finite magnitude that
// any channel of its layer has in its block: that of G, which is negative, 1.5 times that of R.
// Blocks begin at the borders of tiles, so those at the right and lower borders can be smaller than 8 x 8 pixels.
TEST(ExrDwaTest, LimitsOnlyTheBlockWithAnInfiniteValue) {
  constexpr std::size_t kSide = 30, kPixels = kSide * kSide;
  ExrImage image{kSide, kSide, {}};
  for (const char* name : {"R", "G", "lights.R"}) {
    ExrChannel& channel = image.channels.emplace_back(ExrChannel{name, ExrType::f32, std::vector<float>(kPixels)});
    const float factor = channel.name == "R" ? 1.0f : channel.name == "G" ? -1.5f : 2.0f;
    for (std::size_t i = 0; i < kPixels; ++i) channel.samples[i] = factor * (10000.0f + 20.0f * static_cast<float>(i));
  }
  image.channels[1].samples[0] = -std::numeric_limits<float>::infinity();
  const std::vector<const ExrChannel*> channels{&image.channels[0], &image.channels[1], &image.channels[2]};
  for (const std::uint32_t tile : {0u, 8u, 12u, 13u})
    for (std::size_t broken = 0; broken < kPixels; broken += 7) {
      ExrImage encoded = image;
      encoded.channels[0].samples[broken] = std::numeric_limits<float>::infinity();
      DwaLimits limits(image, channels, tile);
      ASSERT_TRUE(limits.tighten(encodeExr(encoded, {ExrCompression::none, {}, tile}), 0));
      const auto inBlock = [&](std::size_t a, std::size_t b) {
        return tile == 0 ? a / 8 == b / 8 : a / tile == b / tile && a % tile / 8 == b % tile / 8;
      };
      std::vector<std::size_t> block;
      for (std::size_t i = 0; i < kPixels; ++i)
        if (inBlock(i % kSide, broken % kSide) && inBlock(i / kSide, broken / kSide)) block.push_back(i);
      const float limit = 0.5f * 1.5f * image.channels[0].samples[block.back()];
      for (const ExrChannel& channel : image.channels) {
        std::vector<float> clamped = channel.samples, expected = channel.samples;
        for (const std::size_t i : block)
          if (channel.name != "lights.R" && std::isfinite(expected[i]))
            expected[i] = std::clamp(expected[i], -limit, limit);
        const std::span<float> upper = std::span(clamped).first(10 * kSide),
                               rest = std::span(clamped).subspan(10 * kSide);
        limits.clamp(channel, 0, upper);
        limits.clamp(channel, upper.size(), rest);
        EXPECT_EQ(clamped, expected) << channel.name << ", tiles " << tile << ", pixel " << broken % kSide << ' '
                                     << broken / kSide;
      }
    }
}

TEST(ExrDwaTest, HalvesTheLimitUntilAllValuesAreFinite) {
  const ExrImage image{8, 8, {{"R", ExrType::f32, std::vector<float>(64, -65504.0f)}}};
  const std::vector<const ExrChannel*> channels{&image.channels[0]};
  DwaLimits limits(image, channels, 0);
  ExrImage encoded = image;
  const auto tightened = [&](float value) {
    encoded.channels[0].samples[63] = value;
    return limits.tighten(encodeExr(encoded, {ExrCompression::none}), 0);
  };
  const auto clamped = [&] {
    std::vector<float> values = image.channels[0].samples;
    limits.clamp(image.channels[0], 0, values);
    EXPECT_EQ(std::ranges::count(values, values[0]), 64);
    return values[0];
  };
  // 15 steps below the largest half: decoders that round differently do not read it as infinity.
  std::ranges::fill(encoded.channels[0].samples, -65024.0f);
  EXPECT_FALSE(tightened(65024.0f));
  EXPECT_EQ(clamped(), -kMaxDwaValue);
  EXPECT_TRUE(tightened(65056.0f));  // the next half
  EXPECT_EQ(clamped(), -0.5f * kMaxDwaValue);
  EXPECT_TRUE(tightened(-std::numeric_limits<float>::infinity()));
  EXPECT_EQ(clamped(), -0.25f * kMaxDwaValue);
}

}  // namespace
}  // namespace quintet::io
