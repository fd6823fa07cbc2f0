// SPDX-License-Identifier: Apache-2.0
// Missing and broken scenes and images: status 1 and one line with the file and the location in it.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "fixtures.h"
#include "io/codec.h"
#include "io/exr/exr.h"

namespace quintet::test {
namespace {

class Input : public CliTest {
 protected:
  // Expects the same error from `info` and `render`.
  void expectRejected(const std::string& file, const std::vector<std::string>& parts) {
    expectError(quintet({"info", file}), 1, parts);
    expectError(quintet({"render", file, "--program", "normals", "--size", "8x8", "--spp", "1", "-q", "-o", "out.png"}),
                1, parts);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
  }
  void expectSceneRejected(const nlohmann::json& json, const std::vector<std::string>& parts) {
    write(folder_ / "bad.gltf", json.dump());
    expectRejected("bad.gltf", parts);
  }
};

TEST_F(Input, MissingFile) { expectRejected("missing.glb", {"missing.glb", "No such file"}); }

TEST_F(Input, Folder) {
  std::filesystem::create_directory(folder_ / "folder.glb");
  expectRejected("folder.glb", {"folder.glb", "directory"});
}

TEST_F(Input, EmptyFile) {
  write(folder_ / "empty.glb", "");
  expectRejected("empty.glb", {"empty.glb"});
}

TEST_F(Input, BrokenJson) {
  write(folder_ / "bad.gltf", "{\n  \"asset\": {\"version\": \"2.0\"},\n  \"nodes\": [}\n");
  expectRejected("bad.gltf", {"bad.gltf", "line 3"});
}

TEST_F(Input, BrokenSceneFile) {
  write(folder_ / "bad.scene.toml", "[[material]]\nname = 'm'\nrougness = 1\n");
  expectRejected("bad.scene.toml", {"bad.scene.toml: line 3", "did you mean 'roughness'"});
}

// `-`, /dev/stdin and named pipes give the same image as the file.
TEST_F(Input, ScenesFromPipes) {
  ASSERT_EQ(quintet(quick({"-o", "file.png"})).status, 0);
  const auto from = [&](const std::string& scene, const std::string& shell) {
    RunOptions options;
    options.shell = shell;
    std::vector<std::string> arguments = quick({"-o", "pipe.png"});
    arguments[1] = scene;
    const RunResult result = quintet(arguments, options);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_EQ(readImage("pipe.png").data, readImage("file.png").data) << scene;
    std::filesystem::remove(folder_ / "pipe.png");
  };
  const std::string fifo = "rm -f p; mkfifo p; cat scene.gltf > p & true";
  from("p", fifo);
  from("-", fifo + "; exec < p");
  from("/dev/stdin", fifo + "; exec < p");
  from("-", "exec < scene.gltf");
  RunOptions options;
  options.shell = fifo + "; exec < p";
  const RunResult info = quintet({"info", "-"}, options);
  EXPECT_EQ(info.status, 0) << info.err;
  options.shell = "exec < /dev/null";
  expectError(quintet({"render", "-", "--size", "8", "-o", "out.png"}, options), 1, {"the file is empty"});
}

// Texels of an environment that are not finite, or whose sums overflow, leave the image finite.
TEST_F(Input, EnvironmentsThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::infinity(), 1e20f, std::numeric_limits<float>::max()}) {
    io::ExrImage sky{16, 8, {}};
    for (const char* name : {"R", "G", "B"})
      sky.channels.push_back({name, io::ExrType::f32, std::vector<float>(128, 1.0f)});
    for (io::ExrChannel& channel : sky.channels) channel.samples[3 * 16 + 5] = bad;
    write(folder_ / "sky.exr", io::encodeExr(sky));
    const RunResult result = quintet({"render", "scene.gltf", "--size", "8x6", "--spp", "8", "--env", "sky.exr", "-o",
                                      "out.exr", "--exr-type", "float", "-q"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.err, ::testing::HasSubstr("warning: sky.exr: 1 pixel is NaN, infinite or above 1e+12"));
    EXPECT_THAT(result.err, ::testing::HasSubstr("(5, 3)"));
    const io::Image image = readImage("out.exr");
    EXPECT_TRUE(std::ranges::all_of(image.samples<float>(), [](float v) { return std::isfinite(v); })) << bad;
  }
}

TEST_F(Input, NeitherSceneNorImage) {
  write(folder_ / "text.txt", "some text");
  expectError(quintet({"info", "text.txt"}), 1, {"text.txt"});
}

TEST_F(Input, IndexOutOfRange) {
  nlohmann::json json = quadScene();
  json["nodes"][0]["mesh"] = 5;
  expectSceneRejected(json, {"bad.gltf: /nodes/0/mesh", "5"});
  json = quadScene();
  json["accessors"][0]["bufferView"] = 17;
  expectSceneRejected(json, {"bad.gltf: /accessors/0/bufferView", "17"});
}

TEST_F(Input, AccessorPastTheEndOfItsBuffer) {
  nlohmann::json json = quadScene();
  json["accessors"][0]["count"] = 5;
  expectSceneRejected(json, {"bad.gltf: /accessors/0", "bytes"});
  json = quadScene();
  json["bufferViews"][2]["byteLength"] = 4000;
  expectSceneRejected(json, {"bad.gltf: /bufferViews/2"});
}

TEST_F(Input, MissingBuffer) {
  nlohmann::json json = quadScene();
  json["buffers"][0]["uri"] = "data.bin";
  expectSceneRejected(json, {"data.bin"});
}

TEST_F(Input, TruncatedPngInGlb) {
  std::vector<std::byte> png = io::encodePng(testImage(64, 64));
  png.resize(png.size() / 2);
  write(folder_ / "bad.glb", texturedGlb(png, "image/png"));
  expectRejected("bad.glb", {"bad.glb: /images/0", "PNG"});
}

TEST_F(Input, TruncatedJpegInGlb) {
  std::vector<std::byte> jpeg = encodeJpeg(testImage(64, 64));
  write(folder_ / "good.glb", texturedGlb(jpeg, "image/jpeg"));
  EXPECT_EQ(quintet({"info", "good.glb"}).status, 0);
  jpeg.resize(jpeg.size() * 3 / 4);
  write(folder_ / "bad.glb", texturedGlb(jpeg, "image/jpeg"));
  expectRejected("bad.glb", {"bad.glb: /images/0", "JPEG"});
}

TEST_F(Input, ExcessiveImageSize) {
  write(folder_ / "bad.glb", texturedGlb(pngWithStatedSize(60000, 60000), "image/png"));
  expectRejected("bad.glb", {"bad.glb: /images/0", "60000"});
  write(folder_ / "bad.png", pngWithStatedSize(2000000000, 2000000000));
  expectError(quintet({"info", "bad.png"}), 1, {"bad.png"});
  expectError(quintet({"compare", "bad.png", "bad.png"}), 1, {"bad.png"});
}

TEST_F(Input, InvalidEnvironment) {
  expectError(quintet(quick({"--env", "missing.hdr", "-o", "out.png"})), 1, {"missing.hdr", "No such file"});
  write(folder_ / "sky.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n");
  expectError(quintet(quick({"--env", "sky.hdr", "-o", "out.png"})), 1, {"sky.hdr"});
  expectError(quintet(quick({"--env", "1,-1,1", "-o", "out.png"})), 2, {"environment", "1,-1,1"});
  expectError(quintet(quick({"--env", "1,x,1", "-o", "out.png"})), 2, {"environment", "1,x,1"});
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
}

TEST_F(Input, ProgramWithAShaderError) {
  std::filesystem::create_directory(folder_ / "mine");
  write(folder_ / "mine" / "program.toml", R"([program]
ray_generation = "mine.rgen"
[[ray]]
name = "radiance"
miss = "mine.rmiss"
[[hit_group]]
name = "all"
[[output]]
name = "color"
)");
  write(folder_ / "mine" / "mine.rgen",
        "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {\n  undefined();\n}\n");
  write(folder_ / "mine" / "mine.rmiss", "#version 460\n#extension GL_EXT_ray_tracing : require\nvoid main() {}\n");
  const RunResult result = quintet({"render", "scene.gltf", "--program", "mine", "--size", "8x8", "-q"});
  EXPECT_EQ(result.status, 1);
  EXPECT_TRUE(result.err.starts_with("mine/mine.rgen:4:")) << result.err;
  EXPECT_NE(result.err.find("undefined"), std::string::npos);
  EXPECT_TRUE(result.err.ends_with("quintet: mine: 1 error\n")) << result.err;
  write(folder_ / "mine" / "program.toml", "[program\n");
  expectError(quintet({"render", "scene.gltf", "--program", "mine", "--size", "8x8", "-q"}), 1,
              {"program.toml", "line 1"});
}

TEST_F(Input, ControlCharactersOfAFileAreNotPrinted) {
  nlohmann::json json = quadScene();
  json["extensionsRequired"] = {"EXT_\x1b[31m\nred"};
  json["extensionsUsed"] = {"EXT_\x1b[31m\nred"};
  write(folder_ / "bad.gltf", json.dump());
  const RunResult result = quintet({"info", "bad.gltf"});
  EXPECT_EQ((result.out + result.err).find('\x1b'), std::string::npos);
}

// With --json, each command prints its error as an object.
TEST_F(Input, ErrorsAsJson) {
  nlohmann::json json = quadScene();
  json["nodes"][0]["mesh"] = 5;
  write(folder_ / "bad.gltf", json.dump());
  for (const std::vector<std::string>& command : {std::vector<std::string>{"render", "bad.gltf", "-o", "out.png"},
                                                  {"run", "normals", "bad.gltf", "-o", "out.png"},
                                                  {"info", "bad.gltf"},
                                                  {"bench", "bad.gltf"}}) {
    std::vector<std::string> arguments = command;
    arguments.push_back("--json");
    const nlohmann::json error = expectJsonError(quintet(arguments), 1, {"bad.gltf: /nodes/0/mesh"});
    EXPECT_EQ(error.at("file"), "bad.gltf") << command[0];
    EXPECT_EQ(error.at("location"), "/nodes/0/mesh") << command[0];
  }
  EXPECT_EQ(expectJsonError(quintet({"compare", "none.png", "b.png", "--json"}), 1, {"none.png"})["location"], nullptr);
  EXPECT_EQ(expectJsonError(quintet({"merge", "none.qfilm", "-o", "a.png", "--json"}), 1, {"none.qfilm"})["file"],
            "none.qfilm");
  EXPECT_EQ(expectJsonError(quintet({"explain", "Q1O1", "--json"}), 2, {"'Q101'"})["file"], nullptr);
  const RunResult check = quintet({"check", "--json"});
  expectError({check.status, "", check.err}, 2, {"program"});
  EXPECT_THAT(nlohmann::json::parse(check.out).at(0)["text"].get<std::string>(),
              testing::HasSubstr("no program given"));
  EXPECT_EQ(expectJsonError(quintet({"render", "--json", "--sice", "3x3"}), 2, {"'--size'"})["file"], nullptr);
}

}  // namespace
}  // namespace quintet::test
