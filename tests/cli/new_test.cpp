// SPDX-License-Identifier: Apache-2.0
// `new`: new programs render and pass the check, and existing files are not overwritten.
#include <algorithm>

#include <gmock/gmock.h>

#include "base/file.h"
#include "fixtures.h"
#include "io/codec.h"

namespace quintet::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class New : public CliTest {
 protected:
  // The program passes the check and renders an image with more than one color.
  void expectWorks(const std::string& name, const std::string& file) {
    const RunResult check = quintet({"check", name, "--strict"});
    EXPECT_EQ(check.status, 0) << check.err;
    const RunResult run = quintet({"run", name, "--size", "48x32", "--spp", "4", "-q", "-o", file});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.err, "");
    const io::Image image = readImage(file);
    const auto corner = image.pixel<std::uint8_t>(1, 1);
    bool differs = false;
    for (std::uint32_t y = 0; y < image.height; ++y)
      differs = differs || !std::ranges::equal(image.pixel<std::uint8_t>(24, y), corner);
    EXPECT_TRUE(differs) << "one color";
  }
};

TEST_F(New, CreatesOneFile) {
  const RunResult created = quintet({"new", "first"});
  ASSERT_EQ(created.status, 0) << created.err;
  EXPECT_THAT(created.out, HasSubstr("quintet run first.rt.glsl --watch"));
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"first.rt.glsl", "scene.gltf"}));
  expectWorks("first.rt.glsl", "a.png");
  expectWorks("first", "b.png");
  EXPECT_EQ(readImage("a.png").data, readImage("b.png").data);
  EXPECT_THAT(quintet({"run", "first", "--help"}).out, HasSubstr("lampDirection"));
}

TEST_F(New, CreatesAFolder) {
  const RunResult created = quintet({"new", "second", "--folder"});
  ASSERT_EQ(created.status, 0) << created.err;
  EXPECT_TRUE(fs::exists(folder_ / "second" / "program.toml"));
  expectWorks("second", "a.png");
  EXPECT_EQ(quintet({"run", "second", "--set", "ambient=0.5", "--size", "8x8", "-q"}).status, 0);
}

TEST_F(New, AcceptsPaths) {
  ASSERT_EQ(quintet({"new", "a/b/deep.rt.glsl"}).status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "a" / "b" / "deep.rt.glsl"));
  expectWorks("a/b/deep.rt.glsl", "a.png");
  ASSERT_EQ(quintet({"new", "a/c d/", "--folder"}).status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "a" / "c d" / "program.toml"));
  const RunResult quoted = quintet({"new", "a/e f"});
  EXPECT_THAT(quoted.out, HasSubstr("quintet run 'a/e f.rt.glsl' --watch"));
  ASSERT_EQ(quintet({"new", (folder_ / "absolute").string()}).status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "absolute.rt.glsl"));
}

TEST_F(New, CopiesPrograms) {
  ASSERT_EQ(quintet({"new", "mine", "--from", "ao"}).status, 0);
  expectWorks("mine", "a.png");
  ASSERT_EQ(quintet({"new", "again", "--from", "mine"}).status, 0);
  EXPECT_EQ(readTextFile(folder_ / "mine" / "ao.rgen"), readTextFile(folder_ / "again" / "ao.rgen"));
}

TEST_F(New, CopiesLessons) {
  ASSERT_EQ(quintet({"new", "mine", "--from", "first_ray"}).status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "mine.rt.glsl"));
  const RunResult own = quintet({"run", "mine", "--size", "32x18", "-q", "-o", "a.png"});
  ASSERT_EQ(own.status, 0) << own.err;
  ASSERT_EQ(quintet({"run", "lessons/01_first_ray", "--size", "32x18", "-q", "-o", "b.png"}).status, 0);
  EXPECT_EQ(readImage("a.png").data, readImage("b.png").data);
  EXPECT_EQ(quintet({"check", "mine", "--strict"}).status, 0);
}

// A new program does not use the scene of a program in the same folder.
TEST_F(New, ScenesBelongToTheirProgram) {
  ASSERT_EQ(quintet({"new", "copy", "--from", "first_ray"}).status, 0);
  ASSERT_TRUE(fs::exists(folder_ / "copy.scene.toml"));
  ASSERT_EQ(quintet({"new", "fresh"}).status, 0);
  const auto scene = [&](const char* name) {
    const RunResult result = quintet({"run", name, "--size", "8x8", "-q", "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    return nlohmann::json::parse(result.out)["scene"].get<std::string>();
  };
  EXPECT_EQ(scene("fresh"), "default scene");
  EXPECT_NE(scene("copy").find("copy.scene.toml"), std::string::npos);
}

TEST_F(New, CopiesRequiredFiles) {
  ASSERT_EQ(quintet({"new", "first"}).status, 0);
  std::string text = readTextFile(folder_ / "first.rt.glsl");
  text.insert(text.find("vec3 color;"), "vec2 unused;\n  ");
  text.insert(text.find("struct RayPayloadType"), "#include \"common.glsl\"\n");
  write(folder_ / "first.rt.glsl", text);
  write(folder_ / "common.glsl", "const float kHalf = 0.5;\n");
  write(folder_ / "other.glsl", "not included\n");
  ASSERT_EQ(quintet({"new", "copies/second", "--from", "first.rt.glsl"}).status, 0);
  EXPECT_EQ(readTextFile(folder_ / "copies" / "second.rt.glsl"), text);
  EXPECT_TRUE(fs::exists(folder_ / "copies" / "common.glsl"));
  EXPECT_FALSE(fs::exists(folder_ / "copies" / "other.glsl"));
  EXPECT_EQ(quintet({"run", "copies/second.rt.glsl", "--size", "8x8", "-q"}).status, 0);
  ASSERT_EQ(quintet({"new", "third", "--from", "first", "--folder"}).status, 0);
  EXPECT_TRUE(fs::exists(folder_ / "third" / "third.rt.glsl"));
  EXPECT_EQ(quintet({"run", "third", "--size", "8x8", "-q"}).status, 0);
}

TEST_F(New, DoesNotOverwriteFiles) {
  write(folder_ / "first.rt.glsl", "mine");
  expectError(quintet({"new", "first"}), 1, {"first.rt.glsl", "exists"});
  EXPECT_EQ(readTextFile(folder_ / "first.rt.glsl"), "mine");
  fs::create_directory(folder_ / "second");
  expectError(quintet({"new", "second", "--folder"}), 1, {"second", "exists"});
  expectError(quintet({"new", "second"}), 1, {"second", "folder"});
  expectError(quintet({"new", "second", "--from", "ao"}), 1, {"second", "exists"});
  EXPECT_EQ(fileNames(), (std::vector<std::string>{"first.rt.glsl", "scene.gltf", "second"}));
}

TEST_F(New, InvalidNames) {
  expectError(quintet({"new"}), 2, {"name", "--help"});
  expectError(quintet({"new", ".."}), 2, {"'..'"});
  expectError(quintet({"new", "x", "--from", "pathtracr"}), 2, {"'pathtracr'", "'pathtracer'"});
  expectError(quintet({"new", "scene.gltf/x"}), 1, {"scene.gltf"});
  EXPECT_EQ(fileNames(), std::vector<std::string>{"scene.gltf"});
}

}  // namespace
}  // namespace quintet::test
