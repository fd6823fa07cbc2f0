// SPDX-License-Identifier: Apache-2.0
// `find`: report, status and the command that explains a sample.
#include <csignal>

#include <gmock/gmock.h>

#include "fixtures.h"
#include "sky_program.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;

class Find : public CliTest {
 protected:
  RunResult find(const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"find", "scene.gltf", "--size", "16x12", "--spp", "4", "-q"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return quintet(arguments);
  }
};

TEST_F(Find, ReportsNothing) {
  const RunResult result = find({"--program", "normals", "--env", "none"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out, "nothing found in 4 samples per pixel\n");
}

// Left of the quad, the image is not finite: 4 pixels of the row.
TEST_F(Find, PrintsACommandThatExplainsTheSample) {
  writeSkyProgram(folder_ / "sky", "payload.color = vec3(sqrt(gl_WorldRayDirectionEXT.x));");
  const std::vector<std::string> arguments{"--program", "sky", "--nan", "--limit=2", "--region", "0,4,16,1"};
  const RunResult text = find(arguments);
  EXPECT_EQ(text.status, 1) << text.err;
  EXPECT_THAT(text.out,
              HasSubstr("16 samples that are not finite in 1 group of adjacent pixels\n  pixel 0,4, sample 0: nan"));
  EXPECT_THAT(text.out, HasSubstr("(4 adjacent pixels from 0,4 to 3,4; 16 samples)\n"));
  EXPECT_THAT(text.out, HasSubstr("sky/sky.rmiss:6: the result of this sqrt is NaN\n")) << "not the store";
  const std::string command = "explain-pixel scene.gltf --size 16x12 --spp 4 --program sky --pixel 0,4 --sample 0";
  EXPECT_THAT(text.out, HasSubstr("    quintet " + command + "\n"));
  const RunResult explained = quintet({"explain-pixel", "scene.gltf", "--size", "16x12", "--spp", "4", "--program",
                                       "sky", "--pixel", "0,4", "--sample", "0"});
  EXPECT_EQ(explained.status, 0) << explained.err;
  EXPECT_THAT(explained.out, HasSubstr("nan nan nan"));
  EXPECT_THAT(explained.out, HasSubstr("The first value that is not finite: sky/sky.rmiss:6, the result of this sqrt"));
  std::vector<std::string> withJson = arguments;
  withJson.push_back("--json");
  const auto json = nlohmann::json::parse(find(withJson).out);
  EXPECT_EQ(json["notFiniteCount"], 16);
  EXPECT_EQ(json["notFiniteGroups"], 1);
  EXPECT_EQ(json["notFinite"].size(), 1u);
  EXPECT_EQ(json["notFinite"][0]["pixel"], nlohmann::json({0, 4}));
  EXPECT_EQ(json["notFinite"][0]["line"], 6);
  EXPECT_EQ(json["notFinite"][0]["operation"], "sqrt");
  EXPECT_THAT(json["notFinite"][0]["command"].get<std::string>(), HasSubstr(command));
}

// The first value that is not finite is an infinity, in an included file; NaN follows from it.
TEST_F(Find, NamesTheOperationThatMadeAnInfinity) {
  writeSkyProgram(folder_ / "sky", "payload.color = spread(gl_WorldRayDirectionEXT);");
  write(folder_ / "sky" / "payload.glsl",
        "struct Payload {\n  vec3 color;\n};\nvec3 spread(vec3 v) {\n  const float zero = min(dot(v, v), 0.0);\n"
        "  const vec3 scaled = v / zero;\n  return scaled * zero;\n}\n");
  const RunResult text = find({"--program", "sky", "--nan", "--region", "0,4,2,1"});
  EXPECT_EQ(text.status, 1) << text.err;
  EXPECT_THAT(text.out, HasSubstr("payload.glsl:6: the result of this division is infinite\n"));
}

TEST_F(Find, CtrlCEndsTheSearch) {
  TerminalRun process(
      {"find", "scene.gltf", "--program", "normals", "--env", "none", "--size", "64x48", "--spp", "16777216"},
      folder_.path());
  ASSERT_TRUE(process.waitFor(" left"));
  process.signal(SIGINT);
  const RunResult result = process.finish();
  EXPECT_EQ(result.status, 130) << result.err;
  EXPECT_THAT(result.err, HasSubstr("interrupted: reporting what was found"));
  EXPECT_THAT(result.err, ::testing::Not(HasSubstr("without an image")));
}

TEST_F(Find, RejectsWrongRequests) {
  expectError(find({"--threshold", "0"}), 2, {"--threshold"});
  expectError(quintet({"find", "scene.gltf", "--time", "1", "--env", "none", "--size", "8x8", "-q"}), 2,
              {"a search requires a number of samples"});
  expectError(find({"--fireflies", "--program", "lessons/09_progressive"}), 2,
              {"fireflies: the program 'lessons/09_progressive' accumulates its frames"});
}

}  // namespace
}  // namespace quintet::test
