// SPDX-License-Identifier: Apache-2.0
// `check` and `explain`, and the diagnostics of `run` and `render` for programs that do not compile.
#include <gmock/gmock.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "sky_program.h"

namespace quintet::test {
namespace {

using testing::AllOf;
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

constexpr const char* kTrace = "  traceRayEXT";

class CheckReports : public Check {
 protected:
  // A program with the warning Q505 in line 11 or, with a suppression, in line 12.
  void writeWideMask(const std::string& name, const std::string& comment) {
    writeProgram(name, "payload.color", "sky.rmiss");
    std::ifstream in(folder_ / name / "sky.rgen");
    std::string text((std::istreambuf_iterator<char>(in)), {});
    const std::size_t mask = text.find("0xFF");
    ASSERT_NE(mask, std::string::npos) << text;
    text.insert(mask + 2, "1");
    if (!comment.empty()) text.insert(text.find(kTrace), comment + "\n");
    write(folder_ / name / "sky.rgen", text);
  }
  nlohmann::json readJson(const std::string& name) {
    std::ifstream in(folder_ / name);
    return nlohmann::json::parse(in);
  }
};

TEST_F(CheckReports, SuppressionsAreCountedAndListed) {
  writeWideMask("wide", "");
  const RunResult warned = quintet({"check", "wide", "--strict"});
  EXPECT_EQ(warned.status, 1);
  EXPECT_THAT(warned.err, HasSubstr("[Q505]"));
  EXPECT_THAT(warned.err, HasSubstr("= fix: "));
  writeWideMask("wide", "  // quintet: allow Q505 the low bits count");
  EXPECT_EQ(quintet({"check", "wide", "--strict"}).err, "wide: clean (1 suppressed)\n");
  const RunResult shown = quintet({"check", "wide", "--strict", "--show-suppressed"});
  EXPECT_EQ(shown.status, 0);
  EXPECT_THAT(shown.err, HasSubstr(": suppressed warning: "));
  EXPECT_THAT(shown.err, HasSubstr(": the low bits count\n"));
  const auto array = nlohmann::json::parse(quintet({"check", "wide", "--json"}).out);
  ASSERT_EQ(array.size(), 1u);
  EXPECT_EQ(array[0]["suppressed"]["reason"], "the low bits count");
  // run does not print it either.
  EXPECT_THAT(quintet({"run", "wide", "--size", "8x8", "-o", "out.png"}).err, Not(HasSubstr("Q505")));
}

TEST_F(CheckReports, ExplainPrintsThePages) {
  writeWideMask("wide", "");
  EXPECT_THAT(quintet({"check", "wide", "--explain"}).err, HasSubstr("\n# Q505: "));
  EXPECT_THAT(quintet({"check", "wide"}).err, Not(HasSubstr("# Q505")));
}

TEST_F(CheckReports, Sarif) {
  writeWideMask("wide", "");
  const RunResult result = quintet({"check", "wide", "good", "--sarif", "out.sarif"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, HasSubstr("wide: 1 warning\n"));
  const nlohmann::json log = readJson("out.sarif");
  ASSERT_EQ(log["runs"][0]["results"].size(), 1u);
  EXPECT_EQ(log["runs"][0]["results"][0]["ruleId"], "Q505");
  const RunResult out = quintet({"check", "wide", "--sarif", "-"});
  EXPECT_EQ(nlohmann::json::parse(out.out)["version"], "2.1.0");
  EXPECT_EQ(quintet({"check", "wide", "--sarif", "-.sarif"}).out, out.out);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "-.sarif"));
  expectError(quintet({"check", "wide", "--sarif", "-.sarif", "--graph", "-.svg"}), 2, {"--sarif", "--graph"});
}

// Each program is checked, and --json prints one array, whatever fails.
TEST_F(CheckReports, ErrorsDoNotHideOtherResults) {
  writeWideMask("wide", "");
  const RunResult unknown = quintet({"check", "wide", "pathtracr", "good"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("[Q505]"));
  EXPECT_THAT(unknown.err, HasSubstr("pathtracr: error: unknown program 'pathtracr' (did you mean 'pathtracer'?)"));
  EXPECT_THAT(unknown.err, testing::EndsWith("pathtracr: 1 error\ngood: clean\n"));
  const auto idsOf = [](const RunResult& result) {
    std::string ids;
    for (const auto& d : nlohmann::json::parse(result.out)) ids += d["id"].get<std::string>() + ";";
    return ids;
  };
  EXPECT_EQ(idsOf(quintet({"check", "wide", "pathtracr", "--json"})), "Q505;;");
  const RunResult parameter = quintet({"check", "wide", "good", "--instrument", "--set", "nothing=1", "--json"});
  EXPECT_EQ(parameter.status, 2);
  EXPECT_EQ(idsOf(parameter), "Q505;;;");
  const RunResult noFile =
      quintet({"check", "wide", "good", "--instrument", "--set-file", "none.json", "--json", "--sarif", "out.sarif"});
  EXPECT_EQ(noFile.status, 1);
  EXPECT_EQ(idsOf(noFile), "Q505;FILE;FILE;");
  EXPECT_EQ(readJson("out.sarif")["runs"][0]["results"].size(), 3u);
  const RunResult noFolder = quintet({"check", "wide", "--json", "--sarif", "none/out.sarif"});
  EXPECT_EQ(noFolder.status, 1);
  EXPECT_EQ(idsOf(noFolder), "Q505;FILE;");
  const RunResult exclusive = quintet({"check", "wide", "--sarif", "-", "--json"});
  EXPECT_EQ(exclusive.status, 2);
  EXPECT_EQ(idsOf(exclusive), ";");
}

TEST_F(CheckReports, Graph) {
  EXPECT_EQ(quintet({"check", "good", "--graph", "out.json"}).status, 0);
  EXPECT_EQ(readJson("out.json")["program"], "good");
  EXPECT_THAT(quintet({"check", "good", "--graph", "-.svg"}).out, HasSubstr("</svg>"));
  EXPECT_THAT(quintet({"check", "good", "--graph", "-.dot"}).out, HasSubstr("digraph"));
  expectError(quintet({"check", "good", "--graph", "out.png"}), 2, {"out.png", ".svg"});
  expectError(quintet({"check", "good", "ao", "--graph", "out.svg"}), 2, {"one program"});
  writeProgram("bad", "payload.tint", "sky.rmiss");
  const RunResult bad = quintet({"check", "bad", "--graph", "bad.svg"});
  EXPECT_EQ(bad.status, 1);
  EXPECT_THAT(bad.err, HasSubstr("bad.svg: not written"));
}

TEST_F(CheckReports, ColorIsChosenByTheOption) {
  writeWideMask("wide", "");
  EXPECT_THAT(quintet({"check", "wide", "--color", "always"}).err, HasSubstr("\x1b[1;35mwarning: "));
  TerminalRun terminal({"check", "wide", "--color", "never"}, folder_.path());
  EXPECT_THAT(terminal.finish().err, Not(HasSubstr("\x1b[1;35m")));
  expectError(quintet({"check", "wide", "--color", "allways"}), 2, {"'allways'", "'always'"});
}

// The regular expression for GitHub and editors matches the first line of diagnostics and no other line.
TEST_F(CheckReports, MatchTheProblemMatcher) {
  std::ifstream in(std::filesystem::path(QUINTET_SOURCE_ROOT) / "docs/examples/github-problem-matcher.json");
  const nlohmann::json pattern = nlohmann::json::parse(in)["problemMatcher"][0]["pattern"][0];
  const std::regex expression(pattern["regexp"].get<std::string>());
  writeWideMask("wide", "");
  std::istringstream lines(quintet({"check", "wide"}).err);
  std::vector<std::string> texts;
  for (std::string line; std::getline(lines, line);) texts.push_back(line);
  std::size_t matched = 0;
  for (const std::string& line : texts) {
    std::smatch match;
    if (!std::regex_match(line, match, expression)) continue;
    ++matched;
    EXPECT_EQ(match[pattern["file"].get<std::size_t>()], "wide/sky.rgen");
    EXPECT_EQ(match[pattern["severity"].get<std::size_t>()], "warning");
    EXPECT_EQ(match[pattern["code"].get<std::size_t>()], "Q505");
    EXPECT_GT(std::stoi(match[pattern["line"].get<std::size_t>()]), 5);
  }
  EXPECT_EQ(matched, 1u);
}

TEST_F(Check, InvalidCommandLines) {
  expectError(quintet({"check"}), 2, {"program", "--help"});
  expectError(quintet({"check", "scene.gltf"}), 2, {"program", "--help"});
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
  expectError(quintet({"check", "wide.rt.glsl", "--timeout", "8"}), 2, {"--timeout requires --instrument"});
}

// The closest-hit shader does not run for the shadow ray.
TEST_F(Check, InstrumentedRunsFindSelfIntersectionsOfShadowRays) {
  write(folder_ / "acne.rt.glsl", R"(struct RayPayloadType { vec3 position; bool hit; };
uniform float bias; // defaultval="0.001"
void main() { /**** RAY GENERATION SHADER ****/
  vec2 p = (vec2(gl_LaunchIDEXT.xy) + 0.5) / vec2(gl_LaunchSizeEXT.xy) - 0.5;
  payload.hit = false;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.1, 2.0, 6.0), 0.001, vec3(p, -1.0), 100.0, 0);
  vec3 position = payload.position;
  bool lit = payload.hit;
  payload.hit = true;
  if (lit) traceRayEXT(topLevelAS, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu,
                       0u, 0u, 0u, position, bias, vec3(0.3, 0.9, 0.4), 100.0, 0);
  gsnSetPixel(vec4(lit && !payload.hit ? 1.0 : 0.0));
}
void main() { /**** CLOSEST-HIT SHADER ****/
  payload.position = gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT;
  payload.hit = true;
}
void main() { /**** MISS SHADER ****/ payload.position = vec3(0.0); payload.hit = false; }
)");
  EXPECT_EQ(quintet({"check", "acne.rt.glsl", "--instrument"}).err, "acne.rt.glsl: clean\n");
  const RunResult found = quintet({"check", "acne.rt.glsl", "--instrument", "--set", "bias=0"});
  EXPECT_THAT(found.err, HasSubstr("acne.rt.glsl:10:12: warning: "));
  EXPECT_THAT(found.err, HasSubstr("[Q005]"));
}

// The error is in code that only an optional output compiles.
TEST_F(Check, CompilesTheCodeOfOptionalOutputs) {
  writeProgram("aov", "payload.color", "sky.rmiss");
  const std::string toml =
      skyToml("sky.rmiss") + "\n[[output]]\nname = \"color\"\n[[output]]\nname = \"extra\"\noptional = true\n";
  write(folder_ / "aov" / "program.toml", toml);
  EXPECT_THAT(quintet({"check", "aov"}).err, AllOf(HasSubstr("no shader stores"), HasSubstr("'extra'")));
  writeSkyProgram(folder_ / "aov",
                  "payload.color = vec3(0.5);\n#ifdef QUINTET_OUTPUT_extra\n  payload.tint = vec3(1.0);\n#endif");
  write(folder_ / "aov" / "program.toml", toml);
  const RunResult result = quintet({"check", "aov"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("aov/sky.rmiss:8:11: error: 'tint'"));
  EXPECT_THAT(result.err, HasSubstr("(with optional output 'extra')"));
}

// SPIR-V of other applications.
TEST_F(Check, ReadsSpirvModulesAndTheirGroups) {
  expectError(quintet({"check", "x", "--groups", "groups.json"}), 2, {"--groups requires --spirv"});
  expectError(quintet({"check", "--spirv"}), 2, {"no SPIR-V file given"});
  expectError(quintet({"check", "--spirv", "x", "--instrument"}), 2, {"exclude each other"});
  RunResult result = quintet({"check", "--spirv", "missing.spv"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("missing.spv: error:"));
  write(folder_ / "text.spv", "#version 460\n");
  result = quintet({"check", "--spirv", "text.spv"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("text.spv: error: byte 0: "), HasSubstr("[FILE]")));
  write(folder_ / "groups.json", "{\"ray_generation\": 3}");
  result = quintet({"check", "--spirv", "text.spv", "--groups", "groups.json", "--json"});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.out, AllOf(HasSubstr("/ray_generation: "), HasSubstr("must be a string")));
}

}  // namespace
}  // namespace quintet::test
