// Layers, compressions, tiles, windows and attributes of our OpenEXR files, read back by ourselves.
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "base/error.h"
#include "io/exr.h"
#include "io/exr_samples.h"

namespace quintet::io {
namespace {

using test::layeredPicture;
using testing::ElementsAre;
using testing::HasSubstr;

const ExrChannel& find(const ExrPicture& picture, const std::string& name) {
  for (const ExrChannel& channel : picture.channels)
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

// Data come back bit for bit, whatever the compression does to colours.
TEST_P(ExrStorageTest, KeepsEveryTypeOfChannel) {
  const ExrPicture picture = layeredPicture(70, 45);
  ExrOptions options{GetParam().compression, std::nullopt, GetParam().tileSize};
  const bool lossy = options.compression == ExrCompression::dwaa || options.compression == ExrCompression::dwab;
  if (lossy) options.level = 200;
  const ExrPicture back = decodeExr(encodeExr(picture, options), "a.exr");
  ASSERT_EQ(back.channels.size(), picture.channels.size());
  double changed = 0;
  for (const ExrChannel& channel : picture.channels) {
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

// What OpenEXR's DWA does to a channel that is not marked as exact: R, G, B, Y, RY and BY lose bits, also as floats
// and also below a layer's name; nothing else does. This is why `exact` exists, and why normal.Y needs it.
TEST(ExrLayersTest, DwaLosesBitsByTheLastPartOfTheName) {
  std::minstd_rand random(3);
  std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
  ExrPicture picture{64, 64, {}};
  for (const char* name : {"R", "A", "Z", "normal.X", "normal.Y", "normal.Z", "uv.U", "uv.V", "ids.R", "crypto00.A",
                           "crypto00.B", "long.red", "small.y", "motion.u"}) {
    ExrChannel channel{name, ExrType::f32, std::vector<float>(64 * 64)};
    for (float& sample : channel.samples) sample = uniform(random);
    picture.channels.push_back(channel);
  }
  std::vector<std::string> lossy;
  const ExrPicture back = decodeExr(encodeExr(picture, {ExrCompression::dwaa}), "a.exr");
  for (const ExrChannel& channel : picture.channels)
    if (!sameBits(find(back, channel.name).samples, channel.samples)) lossy.push_back(channel.name);
  EXPECT_THAT(lossy, ElementsAre("R", "normal.Y", "ids.R", "crypto00.B"));

  for (ExrChannel& channel : picture.channels) channel.exact = true;
  const ExrPicture exact = decodeExr(encodeExr(picture, {ExrCompression::dwab}), "a.exr");
  for (const ExrChannel& channel : picture.channels)
    EXPECT_TRUE(sameBits(find(exact, channel.name).samples, channel.samples)) << channel.name;
}

TEST(ExrLayersTest, LossyFilesHaveTwoParts) {
  const ExrPicture picture = layeredPicture(20, 10);
  const auto one = inspectExr(encodeExr(picture), "a");
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].name, "");
  EXPECT_EQ(one[0].compression, "zip");
  EXPECT_EQ(one[0].channels.size(), picture.channels.size());
  const auto two = inspectExr(encodeExr(picture, {ExrCompression::dwab, std::nullopt, 8}), "a");
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

// A picture of data stays the picture, also where colours of a layer beside it are lossy: its part is the first one.
TEST(ExrLayersTest, LossyFilesBeginWithThePicture) {
  ExrPicture picture{4, 2, {}};
  const auto add = [&](const char* name, float value, bool exact) {
    picture.channels.push_back({name, ExrType::f32, std::vector<float>(8, value), exact});
  };
  for (const char* name : {"tint.R", "tint.G", "tint.B"}) add(name, 0.25f, false);
  add("R", 0.5f, true);
  add("G", -0.5f, true);
  add("B", 1000001.0f, true);
  add("depth.Z", 3.0f, true);
  const std::vector<std::byte> bytes = encodeExr(picture, {ExrCompression::dwaa});
  const auto parts = inspectExr(bytes, "a");
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name, "data");
  EXPECT_EQ(parts[1].name, "rgba");
  const Image shown = decodeImage(bytes, "a.exr");
  ASSERT_EQ(shown.channels, 3u);
  EXPECT_EQ(shown.pixel<float>(3, 1)[0], 0.5f);
  EXPECT_EQ(shown.pixel<float>(3, 1)[1], -0.5f);
  EXPECT_EQ(shown.pixel<float>(3, 1)[2], 1000001.0f);
  const ExrPicture back = decodeExr(bytes, "a.exr");
  EXPECT_TRUE(sameBits(find(back, "R").samples, picture.channels[3].samples));
  EXPECT_NEAR(find(back, "tint.G").samples[0], 0.25f, 0.01f);
  EXPECT_EQ(find(back, "depth.Z").samples[0], 3.0f);
}

TEST(ExrLayersTest, LevelsChangeTheSize) {
  const ExrPicture picture = layeredPicture(128, 128);
  const auto size = [&](ExrCompression compression, float level) {
    return encodeExr(picture, {compression, level}).size();
  };
  EXPECT_LT(size(ExrCompression::dwaa, 500), size(ExrCompression::dwaa, 5));
  EXPECT_LT(size(ExrCompression::zip, 9), size(ExrCompression::zip, 1));
}

TEST(ExrLayersTest, RegionsStandInTheWholePicture) {
  for (const std::uint32_t tile : {0u, 16u}) {
    ExrPicture picture = layeredPicture(30, 20);
    picture.place = {5, 7, 100, 50};
    const auto bytes = encodeExr(picture, {ExrCompression::piz, std::nullopt, tile});
    const ExrPartInfo part = inspectExr(bytes, "a")[0];
    EXPECT_EQ(part.data.x, 5);
    EXPECT_EQ(part.data.y, 7);
    EXPECT_EQ(part.data.width, 30u);
    EXPECT_EQ(part.data.height, 20u);
    EXPECT_EQ(part.display.x, 0);
    EXPECT_EQ(part.display.width, 100u);
    EXPECT_EQ(part.display.height, 50u);
    const ExrPicture back = decodeExr(bytes, "a");
    ASSERT_EQ(back.width, 100u);
    const std::vector<float>& before = find(picture, "depth.Z").samples;
    const std::vector<float>& after = find(back, "depth.Z").samples;
    const std::vector<std::uint32_t>& ids = find(back, "exact.id").integers;
    for (std::uint32_t y = 0; y < 50; ++y)
      for (std::uint32_t x = 0; x < 100; ++x) {
        const bool inside = x >= 5 && x < 35 && y >= 7 && y < 27;
        const std::size_t from = inside ? (y - 7) * 30 + (x - 5) : 0;
        ASSERT_EQ(after[y * 100 + x], inside ? before[from] : 0.0f) << x << ' ' << y;
        ASSERT_EQ(ids[y * 100 + x], inside ? find(picture, "exact.id").integers[from] : 0u) << x << ' ' << y;
      }
  }
}

TEST(ExrLayersTest, KeepsTypedAttributes) {
  mat4 matrix(1.0f);
  matrix[3] = {1, 2, 3, 1};
  ExrPicture picture = layeredPicture(4, 4);
  picture.metadata = {{"Title", "one"}};
  picture.attributes = {{"count", 7},
                        {"half", 0.5f},
                        {"list", std::vector<std::string>{"a", "b"}},
                        {"matrix", matrix},
                        {"pair", vec2(1, 2)},
                        {"third", 1.0 / 3},
                        {"triple", vec3(1, 2, 3)}};
  const ExrPicture back = decodeExr(encodeExr(picture, {ExrCompression::dwaa}), "a");
  EXPECT_EQ(back.metadata, picture.metadata);
  ASSERT_EQ(back.attributes.size(), picture.attributes.size());
  for (std::size_t i = 0; i < back.attributes.size(); ++i) {
    EXPECT_EQ(back.attributes[i].name, picture.attributes[i].name);
    EXPECT_EQ(back.attributes[i].value, picture.attributes[i].value) << back.attributes[i].name;
  }
  const auto described = inspectExr(encodeExr(picture), "a")[0].attributes;
  ASSERT_EQ(described.size(), 8u);
  EXPECT_EQ(described[0].name + described[0].type + described[0].text, "Titlestringone");
  EXPECT_EQ(described[4].text, "1, 0, 0, 0; 0, 1, 0, 0; 0, 0, 1, 0; 1, 2, 3, 1");  // row vectors: translation below
}

TEST(ExrLayersTest, FindsLayers) {
  for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::dwaa}) {
    const ExrPicture picture = layeredPicture(6, 5);
    const auto bytes = encodeExr(picture, {compression});
    const Image normal = decodeExrLayer(bytes, "a.exr", "normal");
    ASSERT_EQ(normal.channels, 3u);
    const std::size_t at = 3 * 6 + 2;
    EXPECT_THAT(normal.pixel<float>(2, 3),
                ElementsAre(find(picture, "normal.X").samples[at], find(picture, "normal.Y").samples[at],
                            find(picture, "normal.Z").samples[at]));
    EXPECT_EQ(decodeExrLayer(bytes, "a.exr", "").channels, 4u);
    EXPECT_EQ(decodeExrLayer(bytes, "a.exr", "albedo").channels, 3u);
    const Image uv = decodeExrLayer(bytes, "a.exr", "uv");  // two channels are no grey with alpha
    ASSERT_EQ(uv.channels, 3u);
    EXPECT_THAT(uv.pixel<float>(2, 3),
                ElementsAre(find(picture, "uv.U").samples[at], find(picture, "uv.V").samples[at], 0.0f));
    const Image one = decodeExrLayer(bytes, "a.exr", "normal.Z");
    ASSERT_EQ(one.channels, 1u);
    EXPECT_EQ(one.pixel<float>(2, 3)[0], find(picture, "normal.Z").samples[at]);
    try {
      decodeExrLayer(bytes, "a.exr", "nornal");
      FAIL();
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr("a.exr: there is no layer 'nornal' (did you mean 'normal'?)"));
    }
  }
}

std::string refusal(const ExrPicture& picture, const ExrOptions& options = {}) {
  try {
    encodeExr(picture, options);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "written";
}

TEST(ExrLayersTest, RefusesWhatNoFileCanHold) {
  const auto with = [](auto&& change) {
    ExrPicture picture = layeredPicture(4, 4);
    change(picture);
    return refusal(picture);
  };
  EXPECT_EQ(with([](ExrPicture&) {}), "written");
  for (const char* name : {"", ".R", "a.", "a..R", "a\n.R"})
    EXPECT_THAT(with([&](ExrPicture& p) { p.channels[0].name = name; }), HasSubstr("cannot be the name")) << name;
  EXPECT_THAT(with([](ExrPicture& p) { p.channels[0].name = std::string(256, 'a'); }), HasSubstr("cannot be the name"));
  EXPECT_THAT(with([](ExrPicture& p) { p.channels[0].integers.resize(16); }), HasSubstr("not of their type"));
  EXPECT_THAT(with([](ExrPicture& p) { p.place = {1, 0, 4, 4}; }), HasSubstr("reach beyond"));
  EXPECT_THAT(with([](ExrPicture& p) { p.place = {0xffffffffu, 0, 70000, 4}; }), HasSubstr("too many for a picture"));
  EXPECT_THAT(with([](ExrPicture& p) { p.attributes = {{"compression", 1}}; }), HasSubstr("'compression'"));
  EXPECT_THAT(with([](ExrPicture& p) { p.attributes = {{"a", 1}, {"a", 2}}; }), HasSubstr("given twice"));
  EXPECT_THAT(with([](ExrPicture& p) { p.attributes = {{" a", 1}}; }), HasSubstr("cannot be a metadata keyword"));
  EXPECT_THAT(with([](ExrPicture& p) {
                for (int i = 0; i < 1024; ++i)
                  p.channels.push_back({"c" + std::to_string(i), ExrType::half, p.channels[0].samples});
              }),
              HasSubstr("too many for an OpenEXR file"));
}

TEST(ExrLayersTest, RefusesLevelsThatDoNotExist) {
  const ExrPicture picture = layeredPicture(4, 4);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  using enum ExrCompression;
  for (const float level : {0.0f, 10.0f, 2.5f, nan})
    EXPECT_THAT(refusal(picture, {zip, level}), HasSubstr("level of zip"));
  for (const float level : {-1.0f, 10001.0f, nan})
    EXPECT_THAT(refusal(picture, {dwaa, level}), HasSubstr("level of dwaa"));
  for (const ExrCompression none : {ExrCompression::none, rle, piz})
    EXPECT_THAT(refusal(picture, {none, 1.0f}), HasSubstr("has no level"));
  EXPECT_THAT(refusal(picture, {zip, std::nullopt, kMaxExrTile + 1}), HasSubstr("at most 4096"));
  ExrPicture many = picture;
  for (int i = 0; i < 22; ++i)
    many.channels.push_back({"c" + std::to_string(i), ExrType::f32, picture.channels[0].samples});
  EXPECT_THAT(refusal(many, {zip, std::nullopt, kMaxExrTile}), HasSubstr("40 channels are too large together"));
  EXPECT_EQ(refusal(picture, {zip, std::nullopt, 1024}), "written");
}

// A file that was cut or changed: a FileError or a picture, nothing else; cut: never a picture.
TEST(ExrLayersTest, BrokenFilesDoNoHarm) {
  for (const ExrOptions& options :
       {ExrOptions{ExrCompression::dwaa, std::nullopt, 4}, ExrOptions{ExrCompression::piz}}) {
    const std::vector<std::byte> good = encodeExr(layeredPicture(9, 7), options);
    const auto picture = [](std::span<const std::byte> bytes) {
      try {
        inspectExr(bytes, "a.exr");
        decodeExr(bytes, "a.exr");
        decodeExrLayer(bytes, "a.exr", "CryptoObject00");
      } catch (const FileError&) {
        return false;
      } catch (const UsageError&) {  // that layer is gone
      }
      return true;
    };
    ASSERT_TRUE(picture(good));
    for (std::size_t size = 0; size < good.size(); size += 3)
      EXPECT_FALSE(picture(std::span(good).first(size))) << size;
    std::minstd_rand random(11);
    int refused = 0;
    for (int i = 0; i < 1500; ++i) {
      std::vector<std::byte> bytes = good;
      for (int k = 0; k < 2; ++k) bytes[random() % bytes.size()] ^= static_cast<std::byte>(1u << random() % 8);
      refused += !picture(bytes);
    }
    EXPECT_GT(refused, 0);
  }
}

TEST(ExrLayersTest, SamePictureSameBytes) {
  const ExrPicture picture = layeredPicture(40, 30);
  for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::dwab})
    EXPECT_EQ(encodeExr(picture, {compression}), encodeExr(picture, {compression}));
}

// Large enough to be compressed by several threads, in blocks of rows.
TEST(ExrLayersTest, LargePicturesComeBack) {
  for (const ExrCompression compression : {ExrCompression::zip, ExrCompression::dwab}) {
    ExrPicture picture = layeredPicture(640, 600);
    const auto bytes = encodeExr(picture, {compression});
    EXPECT_EQ(bytes, encodeExr(picture, {compression}));
    const ExrPicture back = decodeExr(bytes, "a");
    for (const ExrChannel& channel : picture.channels) {
      if (!channel.exact || !channel.integers.empty()) continue;
      EXPECT_TRUE(sameBits(find(back, channel.name).samples, channel.samples)) << channel.name;
    }
  }
}

}  // namespace
}  // namespace quintet::io
