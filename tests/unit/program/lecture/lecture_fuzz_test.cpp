// SPDX-License-Identifier: Apache-2.0
// A lecture-form file is untrusted text: reading it terminates, with diagnostics that point into it or with stages that keep
// its lines.
#include "program/lecture/lecture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "program/compile.h"

namespace quintet::program {
namespace {

constexpr const char* kProgram = R"(// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 2, app: 1"
/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
#define HitAttributeType vec3
uniform vec3 tint; // defaultval="1, 0.5, 0.25" min="0" max="1"
uniform sampler2D wood;
#ifdef NEVER
float helper() { return 0.0; }
#else
float helper() { return PI + userParam0; }
#endif
/**** COMMON END ****/
void main() { /**** RAY GENERATION SHADER ****/
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0), 0.0, vec3(1.0), 1.0, 0);
  gsnSetPixel(vec4(payload.color * helper(), 1.0)); // a comment
}
#if 1
void main() { /**** CLOSEST-HIT SHADER ****/ payload.color = tint; }
#endif
vec3 sky() { return vec3(0.5); }
void main() { /**** MISS SHADER ****/ payload.color = sky(); }
void main() { /**** INTERSECTION SHADER ****/ hit = vec3(1.0); reportIntersectionEXT(1.0, 1u); }
void main() { /**** ANY-HIT SHADER ****/ if (hit.x > 0.5) ignoreIntersectionEXT; }
)";

const std::vector<std::string> kWords{"void main() {",
                                      "{",
                                      "}",
                                      "(",
                                      ")",
                                      ";",
                                      "/*",
                                      "*/",
                                      "//",
                                      "/**** MISS SHADER ****/",
                                      "/**** COMMON START ****/",
                                      "/**** COMMON END ****/",
                                      "/**** CALLABLE SHADER ****/",
                                      "#if 0\n",
                                      "#else\n",
                                      "#endif\n",
                                      "#ifdef A\n",
                                      "#define main foo\n",
                                      "#define RayPayloadType float\n",
                                      "#version 100\n",
                                      "#extension all : enable\n",
                                      "#line 7 \"x\"\n",
                                      "#include \"demo.rt.glsl\"\n",
                                      "#include <quintet/camera.glsl>\n",
                                      "\\\n",
                                      "\n",
                                      "\r\n",
                                      "uniform float",
                                      "uniform",
                                      "= vec3(1, 2)",
                                      "defaultval=\"",
                                      "\"",
                                      "struct RayPayloadType",
                                      "struct HitAttributeType { float x[1000]; };",
                                      "gsnShaderOptions recursion:99999999999999",
                                      std::string(1, '\0'),
                                      "\xEF\xBB\xBF",
                                      "\xFF\xFE",
                                      "int f(",
                                      "layout(",
                                      "/**** X ****/"};

std::string mutated(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  for (std::size_t count = 1 + below(6); count > 0; --count) {
    const std::size_t at = below(text.size() + 1);
    const std::size_t length = std::min(text.size() - at, below(60));
    switch (below(5)) {
      case 0: text.erase(at, length); break;
      case 1: text.insert(at, kWords[below(kWords.size())]); break;
      case 2: text.insert(at, text.substr(below(text.size() + 1), below(200))); break;
      case 3:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 4: text.replace(at, length, kWords[below(kWords.size())]); break;
    }
  }
  return text;
}

// Checks diagnostics, and that every stage ends with the text of the file after "#line 1".
void expectSound(const std::string& text, const Program& program) {
  const std::string& kept = program.files.at("demo.rt.glsl");
  const auto lines = std::count(kept.begin(), kept.end(), '\n');
  for (const Diagnostic& d : program.diagnostics) {
    EXPECT_TRUE(d.id.size() == 4 && d.id.starts_with("Q01")) << d.format();
    EXPECT_TRUE(d.line >= 0 && d.line <= lines + 1 && !d.text.empty()) << d.format();
  }
  if (!program.diagnostics.empty()) return;
  EXPECT_FALSE(program.rayGeneration.empty()) << text;
  for (const auto& [name, stage] : program.files) {
    const std::size_t begin = stage.rfind("#line 1 \"");
    if (name == "demo.rt.glsl" || begin == std::string::npos) continue;
    EXPECT_EQ(std::count(stage.begin() + static_cast<std::ptrdiff_t>(begin), stage.end(), '\n'), lines + 2) << text;
  }
}

TEST(LectureFuzz, ReadsMutationsAsStagesOrDiagnostics) {
  std::mt19937 random(20240416);
  const shader::Compiler compiler{shader::CompilerOptions{}};
  int accepted = 0, rejected = 0, compiled = 0;
  std::string text;
  for (int i = 0; i < 1000; ++i) {
    text = i % 4 == 0 || text.size() > 10000 ? kProgram : text;  // mutations accumulate
    text = mutated(text, random);
    const Program program = parseLecture(text, "demo.rt.glsl", "here");
    expectSound(text, program);
    ++(program.diagnostics.empty() ? accepted : rejected);
    if (program.diagnostics.empty() && compiled < 12 && ++compiled) compile(program, compiler, {});
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(rejected, 100);
}

TEST(LectureFuzz, ReadsRandomBytes) {
  std::mt19937 random(7);
  for (int i = 0; i < 500; ++i) {
    std::string text(std::uniform_int_distribution<std::size_t>(0, 400)(random), ' ');
    for (char& c : text) c = static_cast<char>(std::uniform_int_distribution<int>(0, 255)(random));
    expectSound(text, parseLecture(text, "demo.rt.glsl", "here"));
    for (char& c : text) c = "{}()/*\n#\\\"; a0"[std::uniform_int_distribution<std::size_t>(0, 14)(random)];
    expectSound(text, parseLecture(text, "demo.rt.glsl", "here"));
  }
}

// No part of the front end takes quadratic time, which would take minutes here.
TEST(LectureFuzz, ReadsLargeFilesInLinearTime) {
  const std::string rest = "\nvoid main() { /**** RAY GENERATION SHADER ****/ }\n";
  for (const std::string& word : kWords) {
    std::string text;
    while (text.size() < 400'000) text += word + " ";
    expectSound(text, parseLecture(text + rest, "demo.rt.glsl", "here"));
    expectSound(text, parseLecture(rest + text, "demo.rt.glsl", "here"));
  }
  std::string text;
  for (int i = 0; i < 20000; ++i) text += "uniform float a" + std::to_string(i) + "; // defaultval=\"1\"\n";
  EXPECT_EQ(parseLecture(text + rest, "demo.rt.glsl", "here").diagnostics.at(0).id, "Q015");
  text.clear();
  for (int i = 0; i < 20000; ++i)
    text += "float f" + std::to_string(i) + "() { return f" + std::to_string(i / 2) + "(); }\n";
  for (int i = 0; i < 60; ++i) text += "void main() { /**** CALLABLE SHADER ****/ f9(); }\n";
  EXPECT_TRUE(parseLecture(text + rest, "demo.rt.glsl", "here").diagnostics.empty());
  EXPECT_EQ(parseLecture(std::string(2'000'000, ' '), "demo.rt.glsl", "here").diagnostics.at(0).id, "Q016");
}

}  // namespace
}  // namespace quintet::program
