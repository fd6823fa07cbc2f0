// SPDX-License-Identifier: Apache-2.0
// Round trips of layers, compressions, tiles, windows and attributes of OpenEXR files.
#include <gmock/gmock.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include "base/error.h"
#include "io/codec.h"
#include "io/exr/exr.h"
#include "io/exr_samples.h"

namespace quintet::io {
namespace {

using test::layeredImage;
using testing::ElementsAre;
using testing::HasSubstr;

const ExrChannel& find(const ExrImage& image, const std::string& name) {
  for (const ExrChannel& channel : image.channels)
    if (channel.name == name) return channel;
  throw std::runtime_error("no channel " + name);
}

bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::ranges::equal(a, b, [](float x, float y) {
           return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
         });
}

struct Storage {
  ExrCompression compression;
  std::uint32_t tileSize;
};

class ExrStorageTest : public testing::TestWithParam<Storage> {};

// Data channels keep their bits with every compression.
TEST_P(ExrStorageTest, KeepsEveryTypeOfChannel) {
  const ExrImage image = layeredImage(70, 45);
  ExrOptions options{GetParam().compression, std::nullopt, GetParam().tileSize};
  const bool lossy = options.compression == ExrCompression::dwaa || options.compression == ExrCompression::dwab;
  if (lossy) options.level = 200;
  const ExrImage back = decodeExr(encodeExr(image, options), "a.exr");
  ASSERT_EQ(back.channels.size(), image.channels.size());
  double changed = 0;
  for (const ExrChannel& channel : image.channels) {
    const ExrChannel& read = find(back, channel.name);
    EXPECT_EQ(read.type, channel.type) << channel.name;
    if (!channel.integers.empty())
      EXPECT_EQ(read.integers, channel.integers) << channel.name;
    else if (channel.exact || !lossy)
      EXPECT_TRUE(sameBits(read.samples, channel.samples)) << channel.name;
    else
      for (std::size_t i = 0; i < read.samples.size(); ++i) {
        EXPECT_NEAR(read.samples[i], channel.samples[i], 0.05f * (1 + channel.samples[i])) << channel.name;
        changed += read.samples[i] != channel.samples[i];
      }
  }
  EXPECT_EQ(changed > 0, lossy);
}

std::vector<Storage> allStorages() {
  std::vector<Storage> all;
  for (std::size_t i = 0; i < exrCompressionNames().size(); ++i)
    for (const std::uint32_t tile : {0u, 16u, 33u}) all.push_back({static_cast<ExrCompression>(i), tile});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Exr, ExrStorageTest, testing::ValuesIn(allStorages()), [](const auto& storage) {
  return exrCompressionNames()[static_cast<std::size_t>(storage.param.compression)] +
         (storage.param.tileSize == 0 ? "_lines" : "_tiles" + std::to_string(storage.param.tileSize));
});

// Effect of DWA on channels that are not `exact`: R, G, B, Y, RY and BY lose bits, also as floats and within a layer;
// other channels do not. This is why normal.Y must be `exact`.
TEST(ExrLayersTest, LosesBitsInDwaByTheLastPartOfTheName) {
  std::minstd_rand random(3);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  ExrImage image{64, 64, {}};
  for (const char* name : {"R", "A", "Z", "normal.X", "normal.Y", "normal.Z", "uv.U", "uv.V", "ids.R", "crypto00.A",
                           "crypto00.B", "long.red", "small.y", "motion.u"}) {
    ExrChannel channel{name, ExrType::f32, std::vector<float>(64 * 64)};
    for (float& sample : channel.samples) sample = uniform(random);
    image.channels.push_back(channel);
  }
  std::vector<std::string> lossy;
  const ExrImage back = decodeExr(encodeExr(image, {ExrCompression::dwaa}), "a.exr");
  for (const ExrChannel& channel : image.channels)
    if (!sameBits(find(back, channel.name).samples, channel.samples)) lossy.push_back(channel.name);
  EXPECT_THAT(lossy, ElementsAre("R", "normal.Y", "ids.R", "crypto00.B"));

  for (ExrChannel& channel : image.channels) channel.exact = true;
  const ExrImage exact = decodeExr(encodeExr(image, {ExrCompression::dwab}), "a.exr");
  for (const ExrChannel& channel : image.channels)
    EXPECT_TRUE(sameBits(find(exact, channel.name).samples, channel.samples)) << channel.name;
}

TEST(ExrLayersTest, WritesTwoPartsForLossyCompression) {
  const ExrImage image = layeredImage(20, 10);
  const auto one = inspectExr(encodeExr(image), "a");
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].name, "");
  EXPECT_EQ(one[0].compression, "zip");
  EXPECT_EQ(one[0].channels.size(), image.channels.size());
  const auto two = inspectExr(encodeExr(image, {ExrCompression::dwab, std::nullopt, 8}), "a");
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[0].name, "rgba");
  EXPECT_EQ(two[0].compression, "dwab");
  EXPECT_EQ(two[0].tileWidth, 8u);
  EXPECT_EQ(two[1].name, "data");
  EXPECT_EQ(two[1].compression, "zip");
  EXPECT_EQ(two[1].tileWidth, 8u);
  for (const ExrPartInfo::Channel& channel : two[0].channels)
    EXPECT_THAT(channel.name, testing::MatchesRegex("(albedo[.])?[RGBA]"));
}

// The part with channels without a layer comes first, also if these are data and a color layer is lossy.
TEST(ExrLayersTest, WritesThePartWithoutLayersFirst) {
  ExrImage image{4, 2, {}};
  const auto add = [&](const char* name, float value, bool exact) {
    image.channels.push_back({name, ExrType::f32, std::vector<float>(8, value), exact});
  };
  for (const char* name : {"tint.R", "tint.G", "tint.B"}) add(name, 0.25f, false);
  add("R", 0.5f, true);
  add("G", -0.5f, true);
  add("B", 1000001.0f, true);
  add("depth.Z", 3.0f, true);
  const std::vector<std::byte> bytes = encodeExr(image, {ExrCompression::dwaa});
  const auto parts = inspectExr(bytes, "a");
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "data");
  EXPECT_EQ(parts[1].name, "rgba");
  const Image shown = decodeImage(bytes, "a.exr");
  ASSERT_EQ(shown.channels, 3u);
  EXPECT_EQ(shown.pixel<float>(3, 1)[0], 0.5f);
  EXPECT_EQ(shown.pixel<float>(3, 1)[1], -0.5f);
  EXPECT_EQ(shown.pixel<float>(3, 1)[2], 1000001.0f);
  const ExrImage back = decodeExr(bytes, "a.exr");
  EXPECT_TRUE(sameBits(find(back, "R").samples, image.channels[3].samples));
  EXPECT_NEAR(find(back, "tint.G").samples[0], 0.25f, 0.01f);
  EXPECT_EQ(find(back, "depth.Z").samples[0], 3.0f);
}

TEST(ExrLayersTest, AppliesCompressionLevels) {
  const ExrImage image = layeredImage(128, 128);
  const auto size = [&](ExrCompression compression, float level) {
    return encodeExr(image, {compression, level}).size();
  };
  EXPECT_LT(size(ExrCompression::dwaa, 500), size(ExrCompression::dwaa, 5));
  EXPECT_LT(size(ExrCompression::zip, 9), size(ExrCompression::zip, 1));
}

TEST(ExrLayersTest, StoresRegionsAsDataWindows) {
  for (const std::uint32_t tile : {0u, 16u}) {
    ExrImage image = layeredImage(30, 20);
    image.window = {5, 7, 100, 50};
    const auto bytes = encodeExr(image, {ExrCompression::piz, std::nullopt, tile});
    const ExrPartInfo part = inspectExr(bytes, "a")[0];
    EXPECT_EQ(part.data.x, 5);
    EXPECT_EQ(part.data.y, 7);
    EXPECT_EQ(part.data.width, 30u);
    EXPECT_EQ(part.data.height, 20u);
    EXPECT_EQ(part.display.x, 0);
    EXPECT_EQ(part.display.width, 100u);
    EXPECT_EQ(part.display.height, 50u);
    const ExrImage back = decodeExr(bytes, "a");
    ASSERT_EQ(back.width, 100u);
    const std::vector<float>& before = find(image, "depth.Z").samples;
    const std::vector<float>& after = find(back, "depth.Z").samples;
    const std::vector<std::uint32_t>& ids = find(back, "exact.id").integers;
    for (std::uint32_t y = 0; y < 50; ++y)
      for (std::uint32_t x = 0; x < 100; ++x) {
        const bool inside = x >= 5 && x < 35 && y >= 7 && y < 27;
        const std::size_t from = inside ? (y - 7) * 30 + (x - 5) : 0;
        ASSERT_EQ(after[y * 100 + x], inside ? before[from] : 0.0f) << x << ' ' << y;
        ASSERT_EQ(ids[y * 100 + x], inside ? find(image, "exact.id").integers[from] : 0u) << x << ' ' << y;
      }
  }
}

TEST(ExrLayersTest, KeepsTypedAttributes) {
  mat4 matrix(1.0f);
  matrix[3] = {1, 2, 3, 1};
  ExrImage image = layeredImage(4, 4);
  image.metadata = {{"Title", "one"}};
  image.attributes = {{"count", 7},
                      {"half", 0.5f},
                      {"list", std::vector<std::string>{"a", "b"}},
                      {"matrix", matrix},
                      {"pair", vec2(1, 2)},
                      {"third", 1.0 / 3},
                      {"triple", vec3(1, 2, 3)}};
  const ExrImage back = decodeExr(encodeExr(image, {ExrCompression::dwaa}), "a");
  EXPECT_EQ(back.metadata, image.metadata);
  ASSERT_EQ(back.attributes.size(), image.attributes.size());
  for (std::size_t i = 0; i < back.attributes.size(); ++i) {
    EXPECT_EQ(back.attributes[i].name, image.attributes[i].name);
    EXPECT_EQ(back.attributes[i].value, image.attributes[i].value) << back.attributes[i].name;
  }
  const auto described = inspectExr(encodeExr(image), "a")[0].attributes;
  ASSERT_EQ(described.size(), 8u);
  EXPECT_EQ(described[0].name + described[0].type + described[0].text, "Titlestringone");
  EXPECT_EQ(described[4].text,
            "1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 1, 2, 3, 1");  // row vectors: the translation is the last row
}

TEST(ExrLayersTest, FindsLayers) {
  for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::dwaa}) {
    const ExrImage image = layeredImage(6, 5);
    const auto bytes = encodeExr(image, {compression});
    const Image normal = decodeExrLayer(bytes, "a.exr", "normal");
    ASSERT_EQ(normal.channels, 3u);
    const std::size_t at = 3 * 6 + 2;
    EXPECT_THAT(normal.pixel<float>(2, 3),
                ElementsAre(find(image, "normal.X").samples[at], find(image, "normal.Y").samples[at],
                            find(image, "normal.Z").samples[at]));
    EXPECT_EQ(decodeExrLayer(bytes, "a.exr", "").channels, 4u);
    EXPECT_EQ(decodeExrLayer(bytes, "a.exr", "albedo").channels, 3u);
    const Image uv = decodeExrLayer(bytes, "a.exr", "uv");  // two channels that are not gray and alpha
    ASSERT_EQ(uv.channels, 3u);
    EXPECT_THAT(uv.pixel<float>(2, 3),
                ElementsAre(find(image, "uv.U").samples[at], find(image, "uv.V").samples[at], 0.0f));
    const Image one = decodeExrLayer(bytes, "a.exr", "normal.Z");
    ASSERT_EQ(one.channels, 1u);
    EXPECT_EQ(one.pixel<float>(2, 3)[0], find(image, "normal.Z").samples[at]);
    try {
      decodeExrLayer(bytes, "a.exr", "nornal");
      FAIL();
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), testing::AllOf(HasSubstr("a.exr: "), HasSubstr("'nornal' (did you mean 'normal'?)")));
    }
    try {
      decodeExrLayer(bytes, "a.exr", "\x01");
      FAIL();
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("'?'"));
    }
  }
}

std::string errorOf(const ExrImage& image, const ExrOptions& options = {}) {
  try {
    encodeExr(image, options);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "written";
}

TEST(ExrLayersTest, RejectsInvalidImages) {
  const auto with = [](auto&& change) {
    ExrImage image = layeredImage(4, 4);
    change(image);
    return errorOf(image);
  };
  EXPECT_EQ(with([](ExrImage&) {}), "written");
  for (const char* name : {"", ".R", "a.", "a..R", "a\n.R"})
    EXPECT_THAT(with([&](ExrImage& p) { p.channels[0].name = name; }), HasSubstr("cannot be the name")) << name;
  EXPECT_THAT(with([](ExrImage& p) { p.channels[0].name = std::string(256, 'a'); }), HasSubstr("cannot be the name"));
  EXPECT_THAT(with([](ExrImage& p) { p.channels[0].integers.resize(16); }), HasSubstr("type is not u32"));
  EXPECT_THAT(with([](ExrImage& p) { p.channels[0].samples.resize(1); }), HasSubstr("1 sample for 4 x 4 pixels"));
  EXPECT_THAT(with([](ExrImage& p) { p.window = {1, 0, 4, 4}; }), HasSubstr("exceed the image"));
  EXPECT_THAT(with([](ExrImage& p) { p.window = {0xffffffffu, 0, 70000, 4}; }), HasSubstr("at most 65536"));
  EXPECT_THAT(with([](ExrImage& p) { p.attributes = {{"compression", 1}}; }), HasSubstr("'compression'"));
  EXPECT_THAT(with([](ExrImage& p) { p.attributes = {{"a", 1}, {"a", 2}}; }), HasSubstr("given twice"));
  EXPECT_THAT(with([](ExrImage& p) { p.attributes = {{" a", 1}}; }), HasSubstr("cannot be a metadata keyword"));
  EXPECT_THAT(with([](ExrImage& p) {
                for (int i = 0; i < 1024; ++i)
                  p.channels.push_back({"c" + std::to_string(i), ExrType::half, p.channels[0].samples});
              }),
              HasSubstr("too many for an OpenEXR file"));
}

TEST(ExrLayersTest, RejectsInvalidLevels) {
  const ExrImage image = layeredImage(4, 4);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  using enum ExrCompression;
  for (const float level : {0.0f, 10.0f, 2.5f, nan})
    EXPECT_THAT(errorOf(image, {zip, level}), HasSubstr("level of zip"));
  for (const float level : {-1.0f, 10001.0f, nan})
    EXPECT_THAT(errorOf(image, {dwaa, level}), HasSubstr("level of dwaa"));
  for (const ExrCompression none : {ExrCompression::none, rle, piz})
    EXPECT_THAT(errorOf(image, {none, 1.0f}), HasSubstr("has no level"));
  EXPECT_THAT(errorOf(image, {zip, std::nullopt, kMaxExrTile + 1}), HasSubstr("at most 4096"));
  ExrImage many = image;
  for (int i = 0; i < 22; ++i)
    many.channels.push_back({"c" + std::to_string(i), ExrType::f32, image.channels[0].samples});
  EXPECT_THAT(errorOf(many, {zip, std::nullopt, kMaxExrTile}), HasSubstr("40 channels are too large together"));
  EXPECT_EQ(errorOf(image, {zip, std::nullopt, 1024}), "written");
}

// A changed file gives an image or a FileError; a truncated file always gives a FileError.
TEST(ExrLayersTest, SurvivesCorruptFiles) {
  for (const ExrOptions& options :
       {ExrOptions{ExrCompression::dwaa, std::nullopt, 4}, ExrOptions{ExrCompression::piz}}) {
    const std::vector<std::byte> good = encodeExr(layeredImage(9, 7), options);
    const auto decodes = [](std::span<const std::byte> bytes) {
      try {
        inspectExr(bytes, "a.exr");
        decodeExr(bytes, "a.exr");
        decodeExrLayer(bytes, "a.exr", "CryptoObject00");
      } catch (const FileError&) {
        return false;
      } catch (const UsageError&) {  // the layer is missing
      }
      return true;
    };
    ASSERT_TRUE(decodes(good));
    for (std::size_t size = 0; size < good.size(); size += 3)
      EXPECT_FALSE(decodes(std::span(good).first(size))) << size;
    std::minstd_rand random(11);
    int rejected = 0;
    for (int i = 0; i < 1500; ++i) {
      std::vector<std::byte> bytes = good;
      for (int k = 0; k < 2; ++k) bytes[random() % bytes.size()] ^= static_cast<std::byte>(1u << random() % 8);
      rejected += !decodes(bytes);
    }
    EXPECT_GT(rejected, 0);
  }
}

TEST(ExrLayersTest, IsDeterministic) {
  const ExrImage image = layeredImage(40, 30);
  for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::dwab})
    EXPECT_EQ(encodeExr(image, {compression}), encodeExr(image, {compression}));
}

// Large enough for several compression threads and blocks of rows.
TEST(ExrLayersTest, RoundTripsLargeImages) {
  for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::dwab}) {
    ExrImage image = layeredImage(640, 600);
    const auto bytes = encodeExr(image, {compression});
    EXPECT_EQ(bytes, encodeExr(image, {compression}));
    const ExrImage back = decodeExr(bytes, "a");
    for (const ExrChannel& channel : image.channels) {
      if (!channel.exact || !channel.integers.empty()) continue;
      EXPECT_TRUE(sameBits(find(back, channel.name).samples, channel.samples)) << channel.name;
    }
  }
}

}  // namespace
}  // namespace quintet::io
