// SPDX-License-Identifier: Apache-2.0
// `check` and `explain`, and the diagnostics of `run` and `render` for programs that do not compile.
#include <gmock/gmock.h>

#include "sky_program.h"

namespace quintet::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Check : public CliTest {
 protected:
  Check() { writeProgram("good", "payload.color", "sky.rmiss"); }

  void writeProgram(const std::string& name, const std::string& member, const std::string& miss) {
    writeSkyProgram(folder_ / name, member + " = vec3(0.5);");
    write(folder_ / name / "program.toml", skyToml(miss));
  }
};

// What all commands print about a program whose miss shader writes payload.tint.
constexpr const char* kDiagnostic =
    "bad/sky.rmiss:6:11: error: 'tint' : no such field in structure 'payload' [GLSL]\n"
    "    6 |   payload.tint = vec3(0.5);\n"
    "      |           ^\n";

TEST_F(Check, AcceptsFoldersAndBuiltInPrograms) {
  const RunResult result = quintet({"check", "good", "ao", "pathtracer"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "good: clean\nao: clean\npathtracer: clean\n");
  EXPECT_EQ(quintet({"check", "good", "scene.gltf", "--json"}).out, "[]\n");
}

TEST_F(Check, BuiltInProgramsHaveNoWarnings) {
  std::vector<std::string> arguments{"check", "--strict"};
  for (const auto& entry : nlohmann::json::parse(quintet({"run", "--list", "--json"}).out))
    arguments.push_back(entry["name"]);
  const RunResult result = quintet(arguments);
  EXPECT_EQ(result.status, 0) << result.err;
}

TEST_F(Check, SearchesFoldersForPrograms) {
  writeProgram("all/one", "payload.color", "sky.rmiss");
  writeProgram("all/deep/two", "payload.color", "sky.rmiss");
  write(folder_ / "all" / "three.rt.glsl",
        "void main() { /**** RAY GENERATION SHADER ****/ gsnSetPixel(vec4(1.0)); }\n");
  const RunResult result = quintet({"check", "all", "--strict"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.err, "all/deep/two: clean\nall/one: clean\nall/three.rt.glsl: clean\n");
  std::filesystem::create_directory(folder_ / "empty");
  const RunResult empty = quintet({"check", "empty"});
  EXPECT_EQ(empty.status, 1);
  EXPECT_THAT(empty.err, HasSubstr("program.toml"));
}

TEST_F(Check, ErrorsHaveTheSourceLine) {
  writeProgram("bad", "payload.tint", "sky.rmiss");
  const RunResult result = quintet({"check", "bad"});
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err, std::string(kDiagnostic) + "bad: 1 error\n");
  const RunResult json = quintet({"check", "bad", "good", "--json"});
  EXPECT_EQ(json.status, 1);
  EXPECT_EQ(json.err, "");
  const auto array = nlohmann::json::parse(json.out);
  ASSERT_EQ(array.size(), 1u);
  EXPECT_EQ(array[0]["file"], "bad/sky.rmiss");
  EXPECT_EQ(array[0]["line"], 6);
  EXPECT_EQ(array[0]["column"], 11);
  EXPECT_EQ(array[0]["severity"], "error");
  EXPECT_EQ(array[0]["id"], "GLSL");
}

TEST_F(Check, RunAndRenderPrintTheSameErrors) {
  writeProgram("bad", "payload.tint", "sky.rmiss");
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"run", "bad", "--size", "8x8", "-o", "out.png"},
        {"render", "scene.gltf", "--program", "bad", "--size", "8x8", "-q", "-o", "out.png"}}) {
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(result.err, std::string(kDiagnostic) + "quintet: bad: 1 error\n");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
  }
  const RunResult json = quintet({"run", "bad", "--size", "8x8", "--json", "-o", "out.png"});
  EXPECT_EQ(json.status, 1);
  EXPECT_EQ(nlohmann::json::parse(json.out)[0]["file"], "bad/sky.rmiss");
}

// Included files have the path that the user knows.
TEST_F(Check, ErrorsInIncludedFiles) {
  writeProgram("bad", "payload.color", "sky.rmiss");
  write(folder_ / "bad" / "payload.glsl", "struct Payload {\n  vec3 color;\n  vec5 more;\n};\n");
  const RunResult result = quintet({"check", "bad"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("bad/payload.glsl:3"));
  EXPECT_THAT(result.err, Not(HasSubstr("<bad")));
  EXPECT_THAT(result.err, HasSubstr("    3 |   vec5 more;\n"));
}

// No compiler finds this: a ray generation shader and a miss shader with different payload types.
TEST_F(Check, ErrorsAcrossStages) {
  writeProgram("bad", "payload.color", "sky.rmiss");
  write(folder_ / "bad" / "sky.rmiss",
        "#version 460\n#extension GL_EXT_ray_tracing : require\n"
        "struct Payload { vec4 color; };\nlayout(location = 0) rayPayloadInEXT Payload payload;\n"
        "void main() { payload.color = vec4(0.5); }\n");
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"check", "bad"},
        {"run", "bad", "--size", "8x8", "-o", "out.png"},
        {"render", "scene.gltf", "--program", "bad", "--size", "8x8", "-o", "out.png"}}) {
    const RunResult result = quintet(arguments);
    EXPECT_EQ(result.status, 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr("[Q101]"));
    EXPECT_THAT(result.err, HasSubstr("bad/sky."));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
  }
}

// A warning does not stop `run`. With --strict it makes `check` fail.
TEST_F(Check, Warnings) {
  writeProgram("odd", "payload.color", "sky.rmiss");
  write(folder_ / "odd" / "unused.rchit",
        "#version 460\n#extension GL_EXT_ray_tracing : require\n"
        "#include \"payload.glsl\"\nlayout(location = 0) rayPayloadInEXT Payload payload;\n"
        "void main() { payload.color = vec3(1.0); }\n");
  write(folder_ / "odd" / "program.toml", skyToml("sky.rmiss") +
                                              "[[hit_group]]\nname = \"surface\"\nprimitives = \"unknown "
                                              "name\"\nprimary = { closest_hit = \"unused.rchit\" }\n"
                                              "[[hit_group]]\nname = \"rest\"\nprimary = { }\n");
  EXPECT_EQ(quintet({"check", "odd", "scene.gltf"}).status, 0);
  EXPECT_EQ(quintet({"check", "odd", "scene.gltf", "--strict"}).status, 1);
  const RunResult result = quintet({"run", "odd", "scene.gltf", "--size", "8x8", "--json", "-o", "out.png"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("[Q802]"));
  const auto found = nlohmann::json::parse(result.out)["diagnostics"];
  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(std::ranges::any_of(found, [](const auto& d) { return d["id"] == "Q802"; })) << found;
}

TEST_F(Check, ErrorsInDescriptions) {
  writeProgram("bad", "payload.color", "skyy.rmiss");
  const RunResult result = quintet({"check", "bad"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, ::testing::ContainsRegex("bad/program\\.toml:6: error: .*'skyy\\.rmiss'.*'sky\\.rmiss'"));
  EXPECT_THAT(result.err, HasSubstr("    6 | miss = \"skyy.rmiss\"\n"));
  const auto error = nlohmann::json::parse(quintet({"run", "bad", "--json"}).out).at("error");
  EXPECT_EQ(error["file"], "bad/program.toml");
  EXPECT_EQ(error["location"], "line 6");
  const auto array = nlohmann::json::parse(quintet({"check", "bad", "--json"}).out);
  EXPECT_EQ(array[0]["file"], "bad/program.toml");
  EXPECT_EQ(array[0]["line"], 6);
  const auto scene = nlohmann::json::parse(quintet({"check", "good", "none.glb", "--json"}).out);
  EXPECT_EQ(scene[0]["file"], "none.glb");
}

TEST_F(Check, UsesColorsOnTerminalsOnly) {
  writeProgram("bad", "payload.tint", "sky.rmiss");
  TerminalRun terminal({"check", "bad"}, folder_.path());
  EXPECT_THAT(terminal.finish().err, HasSubstr("\x1b[1;31merror: "));
  EXPECT_THAT(quintet({"check", "bad"}).err, Not(HasSubstr("\x1b")));
}

TEST_F(Check, InvalidCommandLines) {
  expectError(quintet({"check"}), 2, {"program", "--help"});
  expectError(quintet({"check", "scene.gltf"}), 2, {"program", "--help"});
  expectError(quintet({"check", "pathtracr"}), 2, {"'pathtracr'", "'pathtracer'"});
  expectError(quintet({"check", "good", "--jsn"}), 2, {"'--jsn'", "'--json'"});
}

TEST_F(Check, Explain) {
  const RunResult list = quintet({"explain"});
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.out, ::testing::ContainsRegex("\nQ101 +error +payload type"));
  for (const auto& entry : nlohmann::json::parse(quintet({"explain", "--json"}).out)) {
    const std::string id = entry["id"];
    EXPECT_THAT(list.out, HasSubstr(id + "  "));
    for (const char* key : {"severity", "title", "why", "fix", "rule"})
      EXPECT_NE(entry.at(key), "") << id << ' ' << key;
    const RunResult page = quintet({"explain", id});
    EXPECT_EQ(page.status, 0);
    EXPECT_TRUE(page.out.starts_with("# " + id + ": ")) << page.out;
  }
  EXPECT_EQ(quintet({"explain", "q101"}).out, quintet({"explain", "Q101"}).out);
  expectError(quintet({"explain", "Q1O1"}), 2, {"'Q1O1'", "'Q101'"});
}

TEST_F(Check, InstrumentedRunsHaveASizeAndParameters) {
  write(folder_ / "wide.rt.glsl",
        "uniform float bad; // defaultval=\"0\"\nvoid main() { /**** RAY GENERATION SHADER ****/ float t = "
        "float(gl_LaunchIDEXT.x) + 1.0; gsnSetPixel(vec4(t > 100.0 ? sqrt(-t * bad) : t)); }\n");
  const std::vector<std::string> check{"check", "wide.rt.glsl", "--instrument"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), check.begin(), check.end());
    return quintet(more);
  };
  EXPECT_EQ(with({"--set", "bad=1"}).err, "wide.rt.glsl: clean\n");
  EXPECT_EQ(with({"--size", "128x8"}).err, "wide.rt.glsl: clean\n");
  const RunResult found = with({"--size", "128x8", "--set", "bad=1"});
  EXPECT_EQ(found.status, 1);
  EXPECT_THAT(found.err, HasSubstr("at pixel 100, 0"));
  EXPECT_EQ(with({"--size", "128x8", "--set", "bad=1", "--region", "0,0,50,8", "--spp", "3"}).status, 0);
  expectError(quintet({"check", "wide.rt.glsl", "--size", "8x8"}), 2, {"--size requires --instrument"});
}

// The error is in code that only an optional output compiles.
TEST_F(Check, CompilesTheCodeOfOptionalOutputs) {
  writeProgram("aov", "payload.color", "sky.rmiss");
  const std::string toml =
      skyToml("sky.rmiss") + "\n[[output]]\nname = \"color\"\n[[output]]\nname = \"extra\"\noptional = true\n";
  write(folder_ / "aov" / "program.toml", toml);
  EXPECT_EQ(quintet({"check", "aov"}).err, "aov: clean\n");
  writeSkyProgram(folder_ / "aov",
                  "payload.color = vec3(0.5);\n#ifdef QUINTET_OUTPUT_extra\n  payload.tint = vec3(1.0);\n#endif");
  write(folder_ / "aov" / "program.toml", toml);
  const RunResult result = quintet({"check", "aov"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("aov/sky.rmiss:8:11: error: 'tint'"));
  EXPECT_THAT(result.err, HasSubstr("(with optional output 'extra')"));
}

}  // namespace
}  // namespace quintet::test
