// SPDX-License-Identifier: Apache-2.0
// --aov: layers in one OpenEXR file, tested with a program that writes known values.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/file.h"
#include "fixtures.h"
#include "io/exr/cryptomatte.h"
#include "io/exr/exr.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kToml = R"([program]
description = "layers"
ray_generation = "main.rgen"
samples_per_launch = 4
[[ray]]
name = "primary"
miss = "main.rmiss"
[[output]]
name = "color"
[[output]]
name = "position"
pixel = "center"
optional = true
help = "Position"
[[output]]
name = "uv"
channels = ["U", "V"]
optional = true
[[output]]
name = "tint"
kind = "color"
optional = true
[[output]]
name = "cryptomatte_object"
kind = "id"
pixel = "coverage"
optional = true
)";

// Pixel (x, y) has the color (x, y, 1) / 8, the position (x, y, 1e6 + 1) in sample 0, uv (s, s²) in sample s, and tint 0.25.
// Of four samples the first one hits instance 1 and the others hit instance 0. The first column hits nothing.
constexpr const char* kRayGeneration = R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
void main() {
  const uvec2 pixel = launchPixel();
  for (uint i = 0u; i < launch.sampleCount; ++i) {
    const uint s = launch.firstSample + i;
    storeOutput(kOutput_color, pixel, loadOutput(kOutput_color, pixel) + vec4(vec2(pixel), 1.0, 8.0) / 8.0);
#ifdef QUINTET_OUTPUT_position
    if (s == 0u) storeOutput(kOutput_position, pixel, vec4(vec2(pixel), 1000001.0, 1.0));
#endif
#ifdef QUINTET_OUTPUT_uv
    storeOutput(kOutput_uv, pixel, loadOutput(kOutput_uv, pixel) + vec4(float(s), float(s * s), 0.0, 1.0));
#endif
#ifdef QUINTET_OUTPUT_tint
    storeOutput(kOutput_tint, pixel, loadOutput(kOutput_tint, pixel) + vec4(0.25));
#endif
#ifdef QUINTET_OUTPUT_cryptomatte_object
    vec4 ids = loadOutput(kOutput_cryptomatte_object, pixel);
    ids[s % 4u] = pixel.x == 0u ? 0.0 : uintBitsToFloat(0x3F800000u + (s == 0u ? 1u : 0u));
    storeOutput(kOutput_cryptomatte_object, pixel, ids);
#endif
  }
}
)";

class Aov : public CliTest {
 protected:
  Aov() {
    std::filesystem::create_directories(folder_ / "layers");
    write(folder_ / "layers/program.toml", kToml);
    write(folder_ / "layers/main.rmiss", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n");
    write(folder_ / "layers/main.rgen", kRayGeneration);
    nlohmann::json scene = quadScene();  // two instances of the quad, both with the name "left"
    for (auto& node : scene["nodes"])
      if (node.contains("mesh")) node["name"] = "left";
    scene["nodes"].push_back({{"mesh", 0}, {"name", "left"}});
    scene["scenes"][0]["nodes"].push_back(scene["nodes"].size() - 1);
    write(folder_ / "two.gltf", scene.dump());
  }

  static std::vector<std::string> command(const std::vector<std::string>& more) {
    std::vector<std::string> all{"render", "two.gltf", "--program", "layers", "-q", "--size", "6x4"};
    const auto has = [&more](const char* name) { return std::ranges::find(more, name) != more.end(); };
    if (!has("--spp")) all.insert(all.end(), {"--spp", "4"});
    if (!has("-o")) all.insert(all.end(), {"-o", "out.exr"});
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  io::ExrImage render(const std::vector<std::string>& more) {
    const RunResult result = quintet(command(more));
    EXPECT_EQ(result.status, 0) << result.err;
    return io::decodeExr(readFile(folder_ / "out.exr"), "out.exr");
  }
  static const io::ExrChannel& find(const io::ExrImage& image, const std::string& name) {
    const auto at = std::ranges::find(image.channels, name, &io::ExrChannel::name);
    if (at == image.channels.end()) throw std::runtime_error("no channel " + name);
    return *at;
  }
  static std::vector<std::string> channelNames(const io::ExrImage& image) {
    std::vector<std::string> names;
    for (const io::ExrChannel& channel : image.channels) names.push_back(channel.name);
    return names;
  }
  static std::string attribute(const io::ExrImage& image, const std::string& key) {
    for (const auto& [name, text] : image.metadata)
      if (name == key) return text;
    return "";
  }
};

TEST_F(Aov, WritesTheSelectedLayers) {
  const io::ExrImage image = render({"--aov", "position,uv", "--aov", "tint"});
  EXPECT_THAT(channelNames(image),
              ::testing::UnorderedElementsAre("R", "G", "B", "position.X", "position.Y", "position.Z", "uv.U", "uv.V",
                                              "tint.R", "tint.G", "tint.B"));
  EXPECT_EQ(find(image, "R").type, io::ExrType::half);
  EXPECT_EQ(find(image, "tint.R").type, io::ExrType::half);
  EXPECT_EQ(find(image, "position.Z").type, io::ExrType::f32);
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_EQ(find(image, "R").samples[i], static_cast<float>(i % 6) / 8);
    EXPECT_EQ(find(image, "position.X").samples[i], static_cast<float>(i % 6));
    EXPECT_EQ(find(image, "position.Y").samples[i], static_cast<float>(i / 6));
    EXPECT_EQ(find(image, "position.Z").samples[i], 1000001.0f);  // the value of one sample, as a float
    EXPECT_EQ(find(image, "uv.U").samples[i], 1.5f);
    EXPECT_EQ(find(image, "uv.V").samples[i], 3.5f);
    EXPECT_EQ(find(image, "tint.G").samples[i], 0.25f);
  }
  EXPECT_EQ(attribute(image, "Samples"), "4");
  EXPECT_EQ(channelNames(render({})), (std::vector<std::string>{"B", "G", "R"}));
}

TEST_F(Aov, WritesCryptomatteRanks) {
  const io::ExrImage image = render({"--aov", "cryptomatte_object"});
  ASSERT_EQ(image.channels.size(), 3u + 12u);
  const float first = io::cryptomatteId("left"), second = io::cryptomatteId("left#2");
  for (std::size_t i = 0; i < 24; ++i) {
    const bool isHit = i % 6 > 0;
    EXPECT_EQ(find(image, "CryptoObject00.R").samples[i], isHit ? first : 0.0f);
    EXPECT_EQ(find(image, "CryptoObject00.G").samples[i], isHit ? 0.75f : 0.0f);
    EXPECT_EQ(find(image, "CryptoObject00.B").samples[i], isHit ? second : 0.0f);
    EXPECT_EQ(find(image, "CryptoObject00.A").samples[i], isHit ? 0.25f : 0.0f);
    EXPECT_EQ(find(image, "CryptoObject02.A").samples[i], 0.0f);
  }
  EXPECT_EQ(attribute(image, "cryptomatte/3ae39a5/name"), "CryptoObject");
  EXPECT_EQ(nlohmann::json::parse(attribute(image, "cryptomatte/3ae39a5/manifest")),
            nlohmann::json({{"left", io::cryptomatteHex(first)}, {"left#2", io::cryptomatteHex(second)}}));
}

TEST_F(Aov, WritesAllLayersOfARegionWithDwa) {
  const io::ExrImage whole = render({"--aov", "all", "--exr-type", "float", "--spp", "8"});
  EXPECT_EQ(find(whole, "R").type, io::ExrType::f32);
  EXPECT_EQ(find(whole, "sample_count.X").samples, std::vector<float>(24, 8.0f));
  EXPECT_EQ(find(whole, "variance.R").samples, std::vector<float>(24, 0.0f));  // all samples are equal
  const io::ExrImage part = render(
      {"--aov", "all", "--spp", "8", "--region", "2,1,3,2", "--exr-compression", "dwab:30", "--exr-tiles", "16"});
  ASSERT_EQ(part.width, 6u);
  for (const io::ExrChannel& channel : part.channels) {
    if (channel.type == io::ExrType::half) continue;
    for (std::size_t i = 0; i < 24; ++i) {
      const bool inside = i % 6 >= 2 && i % 6 < 5 && i / 6 >= 1 && i / 6 < 3;
      EXPECT_EQ(channel.samples[i], inside ? find(whole, channel.name).samples[i] : 0.0f) << channel.name << ' ' << i;
    }
  }
}

TEST_F(Aov, ListsTheLayers) {
  const RunResult result = quintet({"render", "--program", "layers", "--aov", "list"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, ::testing::ContainsRegex("position +X Y Z +Position\n"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("uv +U V"));
  for (const char* name : {"tint", "cryptomatte_object", "variance", "sample_count"})
    EXPECT_THAT(result.out, HasSubstr(name));
  EXPECT_EQ(quintet({"run", "layers", "--aov", "list"}).out, result.out);
}

TEST_F(Aov, InvalidRequests) {
  const auto expectRejected = [&](const std::vector<std::string>& more, const std::vector<std::string>& parts) {
    expectError(quintet(command(more)), 2, parts);
  };
  expectRejected({"--aov", "positon"}, {"'layers'", "'positon'", "'position'", "tint"});
  expectRejected({"--aov", "color"}, {"'color'", "position"});  // the image itself
  expectRejected({"--aov", "uv", "-o", "out.png"}, {"out.png", "layers", ".exr"});
  expectRejected({"--aov", "uv", "--all-outputs"}, {"layers", "all outputs"});
  expectError(
      quintet({"run", "layers", "two.gltf", "-q", "--size", "6x4", "-o", "a.exr", "--output", "cryptomatte_object"}), 2,
      {"'cryptomatte_object'", "--aov"});
  expectError(quintet({"run", "layers", "two.gltf", "-q", "--aov", "uv"}), 2, {"layers.png", ".exr"});
  for (const std::string& name : fileNames()) EXPECT_FALSE(name.ends_with(".exr") || name.ends_with(".png")) << name;
}

// The error appears before the render.
TEST_F(Aov, RejectsLayersWithTheSameChannels) {
  const auto output = [](const std::string& name) {
    return "[[output]]\nname = \"" + name + "\"\nkind = \"id\"\npixel = \"coverage\"\noptional = true\n";
  };
  write(folder_ / "layers/program.toml", std::string(kToml) + output("object") + output("parts"));
  for (const char* file : {"out.exr", "out.qfilm"})
    for (const char* selected : {"cryptomatte_object,object", "all"})
      expectError(quintet(command({"--aov", selected, "-o", file})), 2,
                  {"'cryptomatte_object'", "'object'", "CryptoObject00.R"});
  EXPECT_EQ(render({"--aov", "parts,object"}).channels.size(), 3u + 2 * 12u);
  // Readers would take CryptoObject200 for a layer of CryptoObject.
  write(folder_ / "layers/program.toml", std::string(kToml) + output("object2") + output("objects"));
  expectError(quintet(command({"--aov", "all"})), 2, {"'object2'", "'cryptomatte_object'"});
  EXPECT_EQ(render({"--aov", "objects,cryptomatte_object"}).channels.size(), 3u + 2 * 12u);
}

TEST_F(Aov, WritesOptionalOutputsAsImages) {
  const RunResult result = quintet(
      {"run", "layers", "two.gltf", "-q", "--size", "6x4", "--spp", "4", "-o", "a.exr", "--output", "position"});
  ASSERT_EQ(result.status, 0) << result.err;
  const io::ExrImage image = io::decodeExr(readFile(folder_ / "a.exr"), "a.exr");
  EXPECT_EQ(find(image, "B").samples[0], 1000001.0f);
  ASSERT_EQ(quintet(command({"-o", "x.exr", "--all-outputs"})).status, 0);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "x.uv.exr"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.cryptomatte_object.exr"));
}

TEST_F(Aov, MergedPartsEqualTheWholeRender) {
  const io::ExrImage whole = render({"--aov", "all", "--spp", "12"});
  for (const char* part : {"0-1", "2"}) {
    const RunResult result =
        quintet(command({"--aov", "all", "--spp", "12", "--batches", part, "-o", std::string(part) + ".qfilm"}));
    ASSERT_EQ(result.status, 0) << result.err;
  }
  const auto merged = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"merge", "2.qfilm", "0-1.qfilm", "-q", "-o", "merged.exr"});
    const RunResult result = quintet(more);
    EXPECT_EQ(result.status, 0) << result.err;
    return io::decodeExr(readFile(folder_ / "merged.exr"), "merged.exr");
  };
  const io::ExrImage all = merged({});
  EXPECT_EQ(channelNames(all), channelNames(whole));
  for (const io::ExrChannel& channel : whole.channels)
    EXPECT_EQ(find(all, channel.name).samples, channel.samples) << channel.name;
  EXPECT_EQ(attribute(all, "cryptomatte/3ae39a5/manifest"), attribute(whole, "cryptomatte/3ae39a5/manifest"));
  EXPECT_EQ(find(all, "CryptoObject00.G").samples[1], 11.0f / 12.0f);  // only sample 0 hits the second instance
  EXPECT_THAT(channelNames(merged({"--aov", "uv"})), ::testing::UnorderedElementsAre("R", "G", "B", "uv.U", "uv.V"));
  expectError(quintet({"merge", "2.qfilm", "0-1.qfilm", "-q", "-o", "m.exr", "--aov", "vu"}), 2, {"'vu'", "'uv'"});
  ASSERT_EQ(quintet({"merge", "2.qfilm", "0-1.qfilm", "-q", "-o", "m.png"}).status, 0);
}

// Layers of the path tracer: a quad at z = 0 and a camera on the z axis.
class PathTracerAov : public Aov {
 protected:
  io::ExrImage renderQuad(const std::vector<std::string>& more) {
    std::vector<std::string> all{"render", "scene.gltf", "-q",      "--size", "16x12", "--spp",
                                 "8",      "-o",         "out.exr", "--aov",  "all"};
    all.insert(all.end(), more.begin(), more.end());
    const RunResult result = quintet(all);
    EXPECT_EQ(result.status, 0) << result.err;
    return io::decodeExr(readFile(folder_ / "out.exr"), "out.exr");
  }
};

TEST_F(PathTracerAov, WritesAllLayers) {
  const io::ExrImage image = renderQuad({"--exr-type", "float"});
  const std::size_t middle = 6 * 16 + 8;
  const auto at = [&](const std::string& name) { return find(image, name).samples[middle]; };
  EXPECT_NEAR(at("normal.Z"), 1.0f, 1e-6f);
  EXPECT_NEAR(at("position.Z"), 0.0f, 1e-5f);
  EXPECT_GT(at("depth.Z"), 0.0f);
  EXPECT_GE(at("distance.X"), at("depth.Z"));
  EXPECT_EQ(at("instance_id.X"), 1.0f);
  EXPECT_GE(at("material_id.X"), 1.0f);
  EXPECT_EQ(at("sample_count.X"), 8.0f);
  EXPECT_EQ(at("motion.X"), 0.0f);
  EXPECT_EQ(at("CryptoObject00.G"), 1.0f);
  EXPECT_EQ(at("CryptoMaterial00.G"), 1.0f);
  EXPECT_EQ(find(image, "depth.Z").samples[0], 1e10f);  // outside of the quad
  EXPECT_EQ(find(image, "CryptoObject00.R").samples[0], 0.0f);
  // The light layers add up to the image.
  for (const char* c : {"R", "G", "B"})
    for (std::size_t i = 0; i < 192; ++i) {
      float sum = 0;
      for (const char* layer : {"emission", "background", "direct_diffuse", "direct_specular", "direct_transmission",
                                "indirect_diffuse", "indirect_specular", "indirect_transmission"})
        sum += find(image, std::string(layer) + "." + c).samples[i];
      EXPECT_NEAR(sum, find(image, c).samples[i], 1e-5f * (1 + std::abs(sum))) << c << ' ' << i;
    }
  // The manifest contains the visible object.
  const auto manifest = nlohmann::json::parse(attribute(image, "cryptomatte/3ae39a5/manifest"));
  EXPECT_TRUE(
      std::ranges::any_of(manifest, [&](const auto& id) { return id == io::cryptomatteHex(at("CryptoObject00.R")); }));
}

TEST_F(PathTracerAov, LayersDoNotChangeTheImage) {
  const io::ExrImage with = renderQuad({"--exr-type", "float"});
  const RunResult plain = quintet(
      {"render", "scene.gltf", "-q", "--size", "16x12", "--spp", "8", "-o", "plain.exr", "--exr-type", "float"});
  ASSERT_EQ(plain.status, 0) << plain.err;
  const io::ExrImage without = io::decodeExr(readFile(folder_ / "plain.exr"), "plain.exr");
  for (const io::ExrChannel& channel : without.channels)
    EXPECT_EQ(channel.samples, find(with, channel.name).samples) << channel.name;
}

// oiiotool lists every layer with every compression. The test fails if it is not installed ('make setup').
TEST_F(PathTracerAov, OiiotoolReadsTheFiles) {
  for (const std::vector<std::string>& more :
       std::vector<std::vector<std::string>>{{"--exr-compression", "piz"},
                                             {"--exr-compression", "dwaa:60", "--exr-tiles", "16"},
                                             {"--exr-tiles", "32"}}) {
    const io::ExrImage image = renderQuad(more);
    const std::string command =
        "oiiotool --info -v -a " + (folder_ / "out.exr").string() + " > " + (folder_ / "info.txt").string() + " 2>&1";
    const int status = std::system(command.c_str());
    const std::string info = readTextFile(folder_ / "info.txt");
    ASSERT_EQ(status, 0) << info << "\n(package openimageio-tools: make setup)";
    for (const io::ExrChannel& channel : image.channels) EXPECT_THAT(info, HasSubstr(channel.name));
    EXPECT_THAT(info, HasSubstr("cryptomatte/3ae39a5/conversion: \"uint32_to_float32\""));
    EXPECT_THAT(info, HasSubstr("CryptoMaterial02.A"));
  }
}

}  // namespace
}  // namespace quintet::test
