// SPDX-License-Identifier: Apache-2.0
// `run --watch` as a process: saved files start a new image, errors print diagnostics, fixed files render again.
#include <chrono>
#include <csignal>
#include <thread>

#include <gmock/gmock.h>

#include "base/math.h"
#include "io/codec.h"
#include "sky_program.h"

namespace quintet::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Watch : public CliTest {
 protected:
  Watch() { writeSkyProgram(folder_ / "sky", "payload.color = vec3(0.5);"); }

  // Replaces the file by a rename, like editors.
  void save(const std::string& file, const std::string& text) {
    write(folder_ / (file + "~"), text);
    fs::rename(folder_ / (file + "~"), folder_ / file);
  }
  void saveSky(const std::string& line) { save("sky/sky.rmiss", skyMiss(line)); }

  static std::vector<std::string> watch(const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"run", "sky", "--watch", "--size", "32x24", "--spp", "4", "-o", "out.exr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  // The color of a corner, where the default scene has no surface.
  vec3 sky() const {
    const io::Image image = readImage("out.exr");
    const auto pixel = image.pixel<float>(1, 1);
    return {pixel[0], pixel[1], pixel[2]};
  }
  void expectSky(vec3 expected) const {
    const vec3 color = sky();
    for (glm::length_t i = 0; i < 3; ++i) EXPECT_NEAR(color[i], expected[i], 1e-3f);
  }
};

TEST_F(Watch, SaveBreakAndFix) {
  TerminalRun process(watch(), folder_.path());
  ASSERT_TRUE(process.waitForNext("watching"));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  expectSky({0.5f, 0.5f, 0.5f});

  saveSky("payload.color = vec3(1.0, 0.25, 0.0);");
  ASSERT_TRUE(process.waitForNext("sky.rmiss saved: out.exr after "));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  expectSky({1.0f, 0.25f, 0.0f});

  saveSky("payload.colr = vec3(0.0);");
  ASSERT_TRUE(process.waitForNext("sky/sky.rmiss:6:11: "));
  ASSERT_TRUE(process.waitForNext("'colr'"));
  ASSERT_TRUE(process.waitForNext("sky: 1 error"));
  expectSky({1.0f, 0.25f, 0.0f});

  save("sky/program.toml", skyToml("nothing.rmiss"));
  ASSERT_TRUE(process.waitForNext("'nothing.rmiss'"));
  save("sky/program.toml", skyToml("sky.rmiss"));
  ASSERT_TRUE(process.waitForNext("sky: 1 error"));

  // Overwrites the file instead of renaming.
  write(folder_ / "sky" / "sky.rmiss", skyMiss("payload.color = vec3(0.0, 0.0, 0.75);"));
  ASSERT_TRUE(process.waitForNext("sky.rmiss saved"));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  expectSky({0.0f, 0.0f, 0.75f});

  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 0) << result.err;
  expectSky({0.0f, 0.0f, 0.75f});
}

TEST_F(Watch, StartsWithAnError) {
  saveSky("nonsense;");
  TerminalRun process(watch(), folder_.path());
  ASSERT_TRUE(process.waitForNext("sky: 1 error"));
  ASSERT_TRUE(process.waitForNext("watching"));
  EXPECT_FALSE(fs::exists(folder_ / "out.exr"));
  saveSky("payload.color = vec3(0.125);");
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  expectSky({0.125f, 0.125f, 0.125f});
  process.signal(SIGTERM);
  EXPECT_EQ(process.finish().status, 0);
}

// An included file outside the program's folder, with and without an error, and a new file in the folder.
TEST_F(Watch, IncludedFiles) {
  write(folder_ / "shared.glsl", "const vec3 kColor = vec3(0.25);\n");
  saveSky("payload.color = kColor;");
  save("sky/payload.glsl", "#include \"../shared.glsl\"\nstruct Payload {\n  vec3 color;\n};\n");
  TerminalRun process(watch(), folder_.path());
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  expectSky({0.25f, 0.25f, 0.25f});
  save("shared.glsl", "const vec3 kColor = vec3(0.75);\n");
  ASSERT_TRUE(process.waitForNext("shared.glsl saved: "));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  expectSky({0.75f, 0.75f, 0.75f});
  save("shared.glsl", "const vec3 kColor = nonsense;\n");
  ASSERT_TRUE(process.waitForNext("shared.glsl:1:"));
  ASSERT_TRUE(process.waitForNext("sky: "));  // the number of errors
  save("shared.glsl", "const vec3 kColor = vec3(0.5);\n");
  ASSERT_TRUE(process.waitForNext("shared.glsl saved: "));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  expectSky({0.5f, 0.5f, 0.5f});
  save("sky/payload.glsl", "#include \"more.glsl\"\nstruct Payload {\n  vec3 color;\n};\n");
  ASSERT_TRUE(process.waitForNext("more.glsl"));
  write(folder_ / "sky" / "more.glsl", "const vec3 kColor = vec3(1.0);\n");
  ASSERT_TRUE(process.waitForNext("more.glsl saved: "));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  expectSky({1.0f, 1.0f, 1.0f});
}

TEST_F(Watch, SceneFile) {
  // normals.exr shows the quad's normal (0, 0, 1) as (0.5, 0.5, 1) until the node is turned.
  TerminalRun process({"run", "normals", "scene.gltf", "--watch", "--size", "32x24", "--spp", "4", "-o", "out.exr"},
                      folder_.path());
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  EXPECT_NEAR(readImage("out.exr").pixel<float>(16, 12)[2], 1.0f, 0.01f);
  nlohmann::json json = quadScene();
  json["nodes"][0]["rotation"] = {0.0, 0.38268343, 0.0, 0.92387953};  // 45 degrees about y
  save("scene.gltf", json.dump());
  ASSERT_TRUE(process.waitForNext("scene.gltf saved: "));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  EXPECT_NEAR(readImage("out.exr").pixel<float>(16, 12)[2], 0.5f + 0.5f * 0.70710678f, 0.01f);
  save("scene.gltf", "{");
  ASSERT_TRUE(process.waitForNext("scene.gltf"));
  ASSERT_TRUE(process.waitForNext("1 error"));
  save("scene.gltf", quadScene().dump());
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  EXPECT_NEAR(readImage("out.exr").pixel<float>(16, 12)[2], 1.0f, 0.01f);
}

TEST_F(Watch, FilesOfASceneFile) {
  write(folder_ / "s.scene.toml", "[[file]]\nname = 'quad'\npath = 'scene.gltf'\n");
  TerminalRun process({"run", "normals", "s.scene.toml", "--watch", "--size", "32x24", "--spp", "4", "-o", "out.exr"},
                      folder_.path());
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  EXPECT_NEAR(readImage("out.exr").pixel<float>(16, 12)[2], 1.0f, 0.01f);
  nlohmann::json json = quadScene();
  json["nodes"][0]["rotation"] = {0.0, 0.38268343, 0.0, 0.92387953};
  save("scene.gltf", json.dump());
  ASSERT_TRUE(process.waitForNext("scene.gltf saved: "));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  EXPECT_NEAR(readImage("out.exr").pixel<float>(16, 12)[2], 0.5f + 0.5f * 0.70710678f, 0.01f);
}

// A buffer of a glTF file, and the image of --env.
TEST_F(Watch, BuffersAndEnvironments) {
  nlohmann::json json = quadScene();
  json["buffers"][0]["uri"] = "quad.bin";
  save("scene.gltf", json.dump());
  const auto quad = [](float z) {
    const float positions[] = {-1, -1, z, 1, -1, z, 1, 1, z, -1, 1, z}, uvs[] = {0, 1, 1, 1, 1, 0, 0, 0};
    const std::uint16_t indices[] = {0, 1, 2, 0, 2, 3};
    std::string bytes(reinterpret_cast<const char*>(positions), sizeof positions);
    bytes.append(reinterpret_cast<const char*>(uvs), sizeof uvs);
    return bytes.append(reinterpret_cast<const char*>(indices), sizeof indices);
  };
  save("quad.bin", quad(0.0f));
  write(folder_ / "sky.png", io::encodePng(testImage(8, 4)));
  TerminalRun process(
      {"run", "normals", "scene.gltf", "--watch", "--size", "32x24", "--spp", "4", "--env", "sky.png", "-o", "out.exr"},
      folder_.path());
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  EXPECT_NEAR(readImage("out.exr").pixel<float>(16, 12)[2], 1.0f, 0.01f);
  save("quad.bin", quad(9.0f));  // behind the camera
  ASSERT_TRUE(process.waitForNext("quad.bin saved: "));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
  EXPECT_LT(readImage("out.exr").pixel<float>(16, 12)[2], 0.9f);
  write(folder_ / "sky.png", io::encodePng(testImage(16, 8)));
  ASSERT_TRUE(process.waitForNext("sky.png saved: "));
  ASSERT_TRUE(process.waitForNext("out.exr: 32x24"));
}

// A saved file stops a long render, which starts over.
TEST_F(Watch, SaveDuringARender) {
  TerminalRun process({"run", "sky", "--watch", "--size", "400x300", "--time", "100000", "-o", "out.exr"},
                      folder_.path());
  ASSERT_TRUE(process.waitForNext(" left"));
  saveSky("payload.color = vec3(0.0, 1.0, 0.0);");
  ASSERT_TRUE(process.waitForNext("sky.rmiss saved: out.exr after "));
  expectSky({0.0f, 1.0f, 0.0f});
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130);
  EXPECT_THAT(result.err, HasSubstr("interrupted"));
  expectSky({0.0f, 1.0f, 0.0f});
}

// An image that the command writes to the program's folder does not start another render.
TEST_F(Watch, IgnoresImagesInTheFolder) {
  TerminalRun process({"run", "sky", "--watch", "--size", "16x16", "--spp", "1", "-o", "sky/out.exr"}, folder_.path());
  ASSERT_TRUE(process.waitForNext("out.exr: 16x16"));
  saveSky("payload.color = vec3(0.25);");
  ASSERT_TRUE(process.waitForNext("sky.rmiss saved"));
  ASSERT_TRUE(process.waitForNext("out.exr: 16x16"));
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err.find("out.exr saved"), std::string::npos) << result.err;
  const std::size_t first = result.err.find("out.exr: 16x16"), second = result.err.find("out.exr: 16x16", first + 1);
  EXPECT_EQ(result.err.find("out.exr: 16x16", second + 1), std::string::npos) << result.err;
}

// The image file of a parameter.
TEST_F(Watch, ImagesOfParameters) {
  write(folder_ / "image.rt.glsl",
        "uniform sampler2D photo;\nvoid main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(texture(photo, "
        "vec2(0.5))); }\n");
  io::Image flat = io::makeImage(2, 2, 3, io::PixelType::u8, io::ColorEncoding::sRgb);
  const auto save = [&](std::uint8_t value) {
    for (auto& sample : flat.samples<std::uint8_t>()) sample = value;
    write(folder_ / "new.png", io::encodePng(flat));
    fs::rename(folder_ / "new.png", folder_ / "flat.png");
  };
  save(0);
  TerminalRun process({"run", "image", "--watch", "--size", "8x8", "--set", "photo=flat.png", "-o", "out.png"},
                      folder_.path());
  ASSERT_TRUE(process.waitForNext("out.png: 8x8"));
  EXPECT_EQ(readImage("out.png").pixel<std::uint8_t>(1, 1)[0], 0);
  save(255);
  ASSERT_TRUE(process.waitForNext("flat.png saved: "));
  ASSERT_TRUE(process.waitForNext("out.png: 8x8"));
  EXPECT_EQ(readImage("out.png").pixel<std::uint8_t>(1, 1)[0], 255);
}

TEST_F(Watch, RejectsStandardOutputAndUnknownPrograms) {
  expectError(quintet({"run", "sky", "--watch", "-o", "-"}), 2, {"--watch"});
  expectError(quintet({"run", "nothing", "--watch"}), 2, {"'nothing'"});
}

}  // namespace
}  // namespace quintet::test
