// SPDX-License-Identifier: Apache-2.0
// `quintet view --script`: commands as lines of JSON, events on standard output, and the images of `quintet render`.
#include <gmock/gmock.h>

#include "base/parse.h"
#include "fixtures.h"

namespace quintet::test {
namespace {

using testing::AllOf;
using ::testing::HasSubstr;

class View : public CliTest {
 protected:
  RunResult view(const std::string& script, const std::vector<std::string>& more = {}) {
    write(folder_ / "script.jsonl", script);
    std::vector<std::string> arguments{"view",  "scene.gltf", "--program", "normals",  "--size",
                                       "32x24", "--spp",      "6",         "--script", "script.jsonl"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
  // Without notes.
  static std::vector<nlohmann::json> events(const RunResult& result) {
    std::vector<nlohmann::json> parsed;
    for (const std::string& line : splitText(result.out, '\n'))
      if (!line.empty()) parsed.push_back(nlohmann::json::parse(line));
    std::erase_if(parsed, [](const nlohmann::json& event) { return event["event"] == "note"; });
    return parsed;
  }
};

TEST_F(View, SavesTheImagesOfRender) {
  const RunResult result = view(R"({"do":"save","file":"a.png"}
{"do":"camera","name":"side"}
{"do":"exposure","stops":1}

{"do":"refine","samples":9}
{"do":"save","file":"b.exr"}
{"do":"save","file":"b.png"}
{"do":"quit"}
not read
)");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const std::vector<nlohmann::json> lines = events(result);
  ASSERT_GE(lines.size(), 2u);
  EXPECT_EQ(lines[0], nlohmann::json::parse(
                          R"({"event":"image","samples":6,"width":32,"height":24,"factor":1,"complete":true})"));
  EXPECT_EQ(lines[1], nlohmann::json::parse(R"({"event":"saved","file":"a.png"})"));
  ASSERT_EQ(quintet(quick({"--size", "32x24", "--spp", "6", "-o", "a2.png"})).status, 0);
  const std::vector<std::string> second{"--size", "32x24", "--spp", "9", "--camera", "side"};
  const auto render = [&](std::vector<std::string> more) {
    more.insert(more.begin(), second.begin(), second.end());
    ASSERT_EQ(quintet(quick(more)).status, 0);
  };
  render({"-o", "b2.exr"});
  render({"-o", "b2.png", "--exposure", "1"});
  for (const char* name : {"a", "b"})
    EXPECT_EQ(readImage(std::string(name) + ".png").data, readImage(std::string(name) + "2.png").data) << name;
  EXPECT_EQ(readImage("b.exr").data, readImage("b2.exr").data);
}

TEST_F(View, AnErrorNamesTheLine) {
  const RunResult result = view("{\"do\":\"refine\"}\n{\"do\":\"orbti\"}\n{\"do\":\"save\",\"file\":\"a.png\"}\n");
  EXPECT_EQ(result.status, 1);
  const std::string message = "unknown command 'orbti' (did you mean 'orbit'?)";
  EXPECT_EQ(result.err, "quintet: script.jsonl: line 2: " + message + "\n");
  EXPECT_EQ(events(result).back(), (nlohmann::json{{"event", "error"}, {"line", 2}, {"message", message}}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.png"));
}

TEST_F(View, KeepGoingContinues) {
  const RunResult result =
      view("{\"do\":\"save\",\"file\":\"a.bmp\"}\n{\"do\":\"save\",\"file\":\"a.png\"}\n", {"--keep-going"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("line 1: a.bmp: "), HasSubstr("extension")));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "a.png"));
}

TEST_F(View, ReadsStandardInput) {
  write(folder_ / "script.jsonl", "{\"do\":\"save\",\"file\":\"a.png\"}");
  const RunResult result =
      quintet({"view", "scene.gltf", "--program", "normals", "--size", "8x8", "--spp", "1", "--script", "-"},
              {.shell = "exec < script.jsonl"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(readImage("a.png").width, 8u);
}

TEST_F(View, PicksAPixel) {
  const RunResult result = view("{\"do\":\"pick\",\"x\":16,\"y\":12}\n{\"do\":\"pick\",\"x\":32,\"y\":0}\n");
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("line 2: "), HasSubstr("32,0"), HasSubstr("32x24")));
  const nlohmann::json picked = events(result).front();
  EXPECT_EQ(picked["event"], "picked");
  EXPECT_EQ(picked["x"], 16);
  EXPECT_TRUE(picked.contains("instance"));
}

TEST_F(View, ExplainsAPixelAsTheCommandDoes) {
  const RunResult result = view("{\"do\":\"explain\",\"x\":16,\"y\":12,\"sample\":1,\"file\":\"pixel.json\"}\n");
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(events(result).front(),
            (nlohmann::json{{"event", "explained"}, {"x", 16}, {"y", 12}, {"sample", 1}, {"file", "pixel.json"}}));
  const RunResult same = quintet({"explain-pixel", "scene.gltf", "--program", "normals", "--size", "32x24", "--spp",
                                  "6", "--pixel", "16,12", "--sample", "1", "--against", "pixel.json"});
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  EXPECT_THAT(same.out, HasSubstr("events are equal"));
}

TEST_F(View, SavesAnImageWithRays) {
  const RunResult result = view(
      "{\"do\":\"save\",\"file\":\"early.png\",\"rays\":true}\n"
      "{\"do\":\"explain\",\"x\":16,\"y\":12,\"file\":\"pixel.json\"}\n"
      "{\"do\":\"save\",\"file\":\"a.exr\",\"rays\":true}\n"
      "{\"do\":\"orbit\",\"dx\":60}\n"
      "{\"do\":\"save\",\"file\":\"plain.png\"}\n"
      "{\"do\":\"save\",\"file\":\"rays.png\",\"rays\":true}\n"
      "{\"do\":\"program\",\"name\":\"ao\"}\n"
      "{\"do\":\"save\",\"file\":\"late.png\",\"rays\":true}\n",
      {"--keep-going"});
  EXPECT_THAT(result.err, HasSubstr("line 1: no pixel"));
  EXPECT_THAT(result.err, AllOf(HasSubstr("line 3: a.exr: "), HasSubstr("PNG")));
  EXPECT_THAT(result.err, HasSubstr("line 8: the program has changed"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "early.png"));
  const io::Image plain = readImage("plain.png"), rays = readImage("rays.png");
  ASSERT_EQ(rays.data.size(), plain.data.size());
  int different = 0;
  for (std::size_t i = 0; i < plain.data.size(); ++i) different += plain.data[i] != rays.data[i];
  EXPECT_GT(different, 50) << "the camera ray from the side";
  EXPECT_LT(different, static_cast<int>(plain.data.size()) / 2);
}

TEST_F(View, RequiresTheScript) {
  expectError(quintet({"view", "scene.gltf", "--script", "missing.jsonl"}), 1, {"missing.jsonl"});
}

// A copy of the binary in a folder of its own, because the build can have a window.
class ViewWindow : public View {
 protected:
  void writeWindow(const std::string& folder, int status) {
    std::filesystem::create_directory(folder_ / folder);
    const std::filesystem::path file = folder_ / folder / "quintet-view";
    write(file, "#!/bin/sh\nprintf '%s|' \"$@\"\nexit " + std::to_string(status) + "\n");
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  RunResult viewAlone(const std::vector<std::string>& arguments) {
    std::filesystem::create_directory(folder_ / "alone");
    return quintet(arguments, {.shell = "cp \"$1\" alone/quintet && shift && set -- alone/quintet \"$@\" && "
                                        "export PATH=\"$PWD/bin:/usr/bin:/bin\""});
  }
};

TEST_F(ViewWindow, GetsAllArguments) {
  writeWindow("bin", 7);
  const RunResult result = viewAlone({"view", "a scene.glb", "--unknown-here", ""});
  EXPECT_EQ(result.out, "a scene.glb|--unknown-here||") << result.err;
  EXPECT_EQ(result.status, 7);
}

TEST_F(ViewWindow, IsTheOneBesideTheBinary) {
  writeWindow("bin", 7);
  writeWindow("alone", 9);
  EXPECT_EQ(viewAlone({"view"}).status, 9);
}

TEST_F(ViewWindow, IsMissing) {
  expectError(viewAlone({"view", "scene.gltf"}), 1, {"quintet-view", "PATH", "--script FILE"});
}

}  // namespace
}  // namespace quintet::test
