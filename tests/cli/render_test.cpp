// SPDX-License-Identifier: Apache-2.0
// Output of `render`: pixels, file formats, metadata, JSON and notes.
#include <gmock/gmock.h>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

class Render : public CliTest {
 protected:
  std::string metadata(const std::string& file, const std::string& keyword) const {
    for (const auto& [key, text] : io::readMetadata(readFile(folder_ / file), file))
      if (key == keyword) return text;
    return "(none)";
  }
  void runOk(const std::vector<std::string>& arguments) {
    const RunResult result = quintet(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
  }
};

TEST_F(Render, NamesTheOutputAfterTheScene) {
  runOk(quick({}));
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"scene.gltf", "scene.png"}));
  const io::Image image = readImage("scene.png");
  EXPECT_EQ(image.width, 32u);
  EXPECT_EQ(image.height, 24u);
  EXPECT_EQ(image.channels, 3u);
}

TEST_F(Render, DerivesTheHeightFromTheCamera) {
  runOk(quick({"--size", "40", "-o", "front.png"}));
  EXPECT_EQ(readImage("front.png").height, 25u);  // aspect ratio 1.6
  runOk(quick({"--size", "40", "--camera", "side", "-o", "side.png"}));
  EXPECT_EQ(readImage("side.png").height, 23u);  // the camera has no aspect ratio: 16:9
}

TEST_F(Render, IsDeterministic) {
  const std::vector<std::string> arguments{"render", "scene.gltf", "--size",    "24x16", "--spp",
                                           "5",      "-q",         "--bounces", "2"};
  auto first = arguments, second = arguments, otherSeed = arguments;
  first.insert(first.end(), {"-o", "first.png"});
  second.insert(second.end(), {"-o", "second.png"});
  otherSeed.insert(otherSeed.end(), {"-o", "other.png", "--seed", "1"});
  runOk(first), runOk(second), runOk(otherSeed);
  EXPECT_EQ(readImage("first.png").data, readImage("second.png").data);
  EXPECT_NE(readImage("first.png").data, readImage("other.png").data);
}

TEST_F(Render, RegionEqualsTheCroppedImage) {
  runOk(quick({"-o", "whole.png", "--spp", "3"}));
  runOk(quick({"-o", "part.png", "--spp", "3", "--region", "5,7,19,11"}));
  const io::Image whole = readImage("whole.png");
  const io::Image part = readImage("part.png");
  ASSERT_EQ(part.width, 19u);
  ASSERT_EQ(part.height, 11u);
  for (std::uint32_t y = 0; y < part.height; ++y)
    for (std::uint32_t x = 0; x < part.width; ++x) {
      const auto a = part.pixel<std::uint8_t>(x, y);
      const auto b = whole.pixel<std::uint8_t>(x + 5, y + 7);
      ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin())) << x << ' ' << y;
    }
  EXPECT_EQ(metadata("part.png", "Region"), "5,7,19,11");
}

TEST_F(Render, WritesPngToStandardOutput) {
  const RunResult result = quintet(quick({"-o", "-"}));
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const io::Image image = io::decodeImage(std::as_bytes(std::span(result.out)), "standard output");
  EXPECT_EQ(image.width, 32u);
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

TEST_F(Render, ExrAndHdrContainTheSameRadiance) {
  runOk(quick({"-o", "out.exr"}));
  runOk(quick({"-o", "out.HDR"}));
  const io::Image exr = readImage("out.exr");
  const io::Image hdr = readImage("out.HDR");
  ASSERT_EQ(exr.sampleCount(), hdr.sampleCount());
  for (std::size_t i = 0; i < exr.sampleCount(); ++i)
    EXPECT_NEAR(exr.samples<float>()[i], hdr.samples<float>()[i], 0.01f);
  EXPECT_EQ(metadata("out.exr", "Samples"), "1");
}

TEST_F(Render, TransparentImagesHaveAlpha) {
  runOk(quick({"-o", "out.png", "--transparent"}));
  const io::Image image = readImage("out.png");
  ASSERT_EQ(image.channels, 4u);
  EXPECT_EQ(image.pixel<std::uint8_t>(0, 0)[3], 0);
  EXPECT_EQ(image.pixel<std::uint8_t>(16, 12)[3], 255);
}

TEST_F(Render, ExposureAndToneMapChangeTheImage) {
  runOk(quick({"-o", "plain.png", "--tonemap", "linear"}));
  runOk(quick({"-o", "dark.png", "--tonemap", "linear", "--exposure", "-2"}));
  runOk(quick({"-o", "aces.png", "--tonemap", "aces"}));
  EXPECT_LT(readImage("dark.png").pixel<std::uint8_t>(16, 12)[0],
            readImage("plain.png").pixel<std::uint8_t>(16, 12)[0]);
  EXPECT_NE(readImage("aces.png").data, readImage("plain.png").data);
  EXPECT_EQ(metadata("dark.png", "Exposure"), "-2");
  EXPECT_EQ(metadata("aces.png", "ToneMap"), "aces");
}

TEST_F(Render, MetadataRecordsTheCommandAndSettings) {
  runOk(quick({"-o", "out.png", "--seed", "7", "--spp", "6"}));
  EXPECT_THAT(metadata("out.png", "Software"), HasSubstr("quintet 0."));
  EXPECT_EQ(metadata("out.png", "Command"),
            "quintet render scene.gltf --program normals --quiet --size 32x24 -o out.png --seed 7 --spp 6");
  EXPECT_EQ(metadata("out.png", "SceneHash").size(), 32u);
  EXPECT_EQ(metadata("out.png", "Seed"), "7");
  EXPECT_EQ(metadata("out.png", "Samples"), "6");
  EXPECT_EQ(metadata("out.png", "Program"), "normals");
  EXPECT_EQ(metadata("out.png", "Rays"), std::to_string(32 * 24 * 6));
  for (const char* keyword : {"Device", "Driver", "Seconds", "Parameters", "ToneMap", "Exposure"})
    EXPECT_NE(metadata("out.png", keyword), "(none)") << keyword;
}

TEST_F(Render, JsonReportsTheRender) {
  const RunResult result = quintet(quick({"-o", "out.png", "--json", "--spp", "2"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["output"], "out.png");
  EXPECT_EQ(json["size"], nlohmann::json({32, 24}));
  EXPECT_EQ(json["samples"], 2);
  EXPECT_EQ(json["rays"], 32 * 24 * 2);
  EXPECT_GT(json["raysPerSecond"], 0.0);
  EXPECT_EQ(json["sceneHash"], metadata("out.png", "SceneHash"));
  for (const char* step : {"load", "compile", "pipeline", "build", "render", "firstPixel", "total"})
    EXPECT_GE(json["seconds"][step], 0.0) << step;
  EXPECT_GT(json["bytes"]["film"], 0);
  EXPECT_EQ(json["interrupted"], false);
}

TEST_F(Render, JsonReportsMemory) {
  const RunResult result = quintet(quick({"-o", "out.png", "--json"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const auto& memory = json["memory"];
  const auto bytes = [&](const char* key) { return memory[key].get<std::uint64_t>(); };
  EXPECT_EQ(bytes("textureBytes"), json["bytes"]["textures"]);
  EXPECT_EQ(bytes("geometryBytes"), json["bytes"]["geometry"]);
  EXPECT_GE(bytes("accelerationBytes"), json["bytes"]["accelerationStructures"].get<std::uint64_t>());
  const std::uint64_t needed = bytes("geometryBytes") + bytes("textureBytes") + bytes("accelerationBytes");
  EXPECT_GE(bytes("peakDeviceBytes"), needed + json["bytes"]["film"].get<std::uint64_t>());
  EXPECT_GT(bytes("peakHostBytes"), 0u);
  std::uint64_t sum = 0;
  for (const auto& [purpose, size] : json["devicePeak"].items()) sum += size.get<std::uint64_t>();
  EXPECT_EQ(sum, bytes("peakDeviceBytes"));
  EXPECT_EQ(json["devicePeak"].size(), 8u);
  const std::uint64_t peak = memory["deviceIsHost"].get<bool>()
                                 ? bytes("peakHostBytes")
                                 : std::max(bytes("peakHostBytes"), bytes("peakDeviceBytes"));
  const double ratio = static_cast<double>(peak) / static_cast<double>(needed);
  EXPECT_NEAR(memory["ratio"].get<double>(), ratio, 1e-6 * ratio);
  double known = 0;
  for (const char* stage : {"document", "meshes", "images", "hash", "view"})
    known += json["stages"][stage].get<double>();
  EXPECT_LE(known, json["seconds"]["load"].get<double>() + 1e-3);
  for (const char* stage : {"lights", "upload", "order", "bottomLevel", "topLevel", "firstLaunch"})
    EXPECT_GE(json["stages"][stage].get<double>(), 0.0) << stage;
}

// Besides scene and film the device has staging buffers, tables and free space in memory blocks.
TEST_F(Render, NeedsLittleMemoryBesidesSceneAndFilm) {
  const RunResult result = quintet({"render", "scene.gltf", "--program", "normals", "--size", "640x360", "--spp", "1",
                                    "-q", "--json", "-o", "out.png"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  const auto& memory = json["memory"];
  const auto bytes = [&](const char* key) { return memory[key].get<std::uint64_t>(); };
  const auto film = json["bytes"]["film"].get<std::uint64_t>();
  EXPECT_GE(film, 640u * 360 * 150);
  const std::uint64_t needed = bytes("geometryBytes") + bytes("textureBytes") + bytes("accelerationBytes");
  EXPECT_LE(bytes("peakDeviceBytes"), needed + film + (std::uint64_t{20} << 20));
}

TEST_F(Render, NotesTheDefaultEnvironment) {
  const std::vector<std::string> arguments{"render", "scene.gltf", "--program", "normals",
                                           "--size", "8x8",        "--spp",     "1"};
  const RunResult result = quintet(arguments);
  EXPECT_THAT(result.err, HasSubstr("default environment"));
  EXPECT_THAT(result.err, HasSubstr("scene.png: 8x8, 1 sample"));
  EXPECT_EQ(result.err.find('\x1b'), std::string::npos);
  EXPECT_EQ(quintet(quick({})).err, "");
  auto none = arguments;
  none.insert(none.end(), {"--env", "none"});
  EXPECT_EQ(quintet(none).err.find("environment"), std::string::npos);
}

TEST_F(Render, StopsAtTheTimeLimit) {
  const RunResult result = quintet(quick({"-o", "out.png", "--json", "--time", "0.5"}));
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_GE(json["samples"], 4);
  EXPECT_LT(json["seconds"]["render"], 60.0);
  const auto both =
      nlohmann::json::parse(quintet(quick({"-o", "out.png", "--json", "--time", "1000", "--spp", "2"})).out);
  EXPECT_EQ(both["samples"], 2);
}

TEST_F(Render, UsesTheCameraOfTheCommandLine) {
  runOk(quick({"-o", "file.png"}));
  runOk(quick({"-o", "same.png", "--look-from", "0,0,4", "--look-at", "0,0,0", "--fov", "45.8366236"}));
  runOk(quick({"-o", "away.png", "--look-from=0,0,4", "--look-at", "0,0,8"}));
  const auto json = nlohmann::json::parse(quintet({"compare", "file.png", "same.png", "--json"}).out);
  EXPECT_LT(json["mae8"], 0.5);
  EXPECT_EQ(readImage("away.png").pixel<std::uint8_t>(16, 12)[0], 0);
}

TEST_F(Render, UsesAConstantEnvironment) {
  runOk({"render", "scene.gltf", "--size", "8x8", "--spp", "1", "-q", "-o", "sky.exr", "--look-from", "0,0,4",
         "--look-at", "0,0,8", "--env", "0.25,0.5,1", "--env-intensity", "2"});
  const io::Image image = readImage("sky.exr");
  EXPECT_NEAR(image.pixel<float>(4, 4)[0], 0.5f, 1e-3f);
  EXPECT_NEAR(image.pixel<float>(4, 4)[2], 2.0f, 1e-2f);
}

}  // namespace
}  // namespace quintet::test
