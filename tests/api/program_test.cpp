// SPDX-License-Identifier: Apache-2.0
// Programs from strings and files, diagnostics as data, and the device list.
#include <gmock/gmock.h>

#include "scenes.h"

namespace quintet::test {
namespace {

using testing::Contains;
using testing::SizeIs;

constexpr const char* kConstant = R"(
/**** COMMON START ****/
struct RayPayloadType { vec3 color; };
/**** COMMON END ****/
/**** RAY GENERATION SHADER ****/
uniform vec3 tint;  // defaultval="1, 0.5, 0.25"
void main() {
  traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, 0u, 0u, 0u, vec3(0, 0, 5), 0.001, vec3(0, 1, 0), 100.0, 0);
  gsnSetPixel(vec4(payload.color * tint, 1.0));
}
/**** CLOSEST-HIT SHADER ****/
void main() { payload.color = vec3(1.0); }
/**** MISS SHADER ****/
void main() { payload.color = vec3(1.0); }
)";

TEST(ApiProgram, FromSourceRenders) {
  const Program program = Program::fromSource(kConstant, "constant");
  EXPECT_EQ(program.name(), "constant");
  ASSERT_THAT(program.parameters(), SizeIs(1));
  EXPECT_EQ(program.parameters()[0].name, "tint");
  EXPECT_TRUE(checkProgram(program).empty());
  Renderer renderer(device(), Scene::of(program), program, {.width = 8, .height = 4});
  renderer.render(1);
  EXPECT_NEAR(renderer.image().at(3, 2)[1], 0.214f, 0.001f);  // the program writes sRGB-encoded values
  renderer.setParameter("tint", "0,0.75,0");
  renderer.render(1);
  EXPECT_NEAR(renderer.image().at(3, 2)[1], 0.5225f, 0.001f);
  EXPECT_THROW(renderer.saveCheckpoint("unused.qfilm"), UsageError);
  EXPECT_THROW(renderer.render({.error = 0.1}), UsageError);
}

TEST(ApiProgram, FramesOfAllCallsCount) {
  const Program program = Program::fromSource(kConstant, "constant");
  Renderer renderer(device(), Scene::of(program), program, {.width = 8, .height = 4});
  const double first = renderer.render(1).seconds;
  const RenderReport second = renderer.render(1);
  EXPECT_GT(first, 0);
  EXPECT_GT(second.seconds, first);
  // Limits that are reached already: nothing more is rendered.
  const RenderReport samples = renderer.render({.samples = 2});
  EXPECT_EQ(samples.reason, StopReason::samples);
  EXPECT_EQ(samples.samples, 2);
  EXPECT_EQ(samples.seconds, second.seconds);
  const RenderReport time = renderer.render({.seconds = first});
  EXPECT_EQ(time.reason, StopReason::time);
  EXPECT_EQ(time.samples, 2);
  const auto secondsOfFilm = [&] {
    for (const auto& [name, text] : renderer.film().metadata())
      if (name == "Seconds") return std::stod(text);
    return -1.0;
  };
  EXPECT_GT(secondsOfFilm(), 0);
  renderer.restart();
  EXPECT_EQ(secondsOfFilm(), 0);
}

constexpr const char* kDescription = R"([program]
ray_generation = "main.rgen"
[[ray]]
name = "radiance"
miss = "<quintet/stages/radiance.rmiss>"
[[hit_group]]
name = "all"
radiance = { closest_hit = "<quintet/stages/surface.rchit>" }
[[output]]
name = "color"
[[parameter]]
name = "level"
type = "float"
default = 0.25
)";

constexpr const char* kRayGeneration = R"(#version 460
#extension GL_EXT_ray_tracing : require
#include <quintet/output.glsl>
#include <quintet/trace.glsl>
#include "level.glsl"
void main() {
  const uvec2 pixel = launchPixel();
  const HitPayload hit = traceClosest(vec3(0.0, 9.0, 0.0), vec3(0.0, -1.0, 0.0), kInfinity, 0u);
  storeOutput(kOutput_color, pixel, loadOutput(kOutput_color, pixel) + float(launch.sampleCount) * level(hit.t));
}
)";

constexpr const char* kInclude = R"(
vec4 level(float t) { return vec4(t > 0.0 ? parameters.level : 0.0, 0.0, 0.0, 1.0); }
)";

TEST(ApiProgram, FromFilesRenders) {
  const Program program = Program::fromFiles(
      {{"program.toml", kDescription}, {"main.rgen", kRayGeneration}, {"level.glsl", kInclude}}, "level");
  EXPECT_EQ(program.name(), "level");
  for (const Diagnostic& diagnostic : checkProgram(program)) {
    EXPECT_NE(diagnostic.severity, Severity::error) << diagnostic.format();
  }
  Renderer renderer(device(), lampScene(), program, {.width = 8, .height = 4});
  renderer.render(4);
  EXPECT_EQ(renderer.image().at(2, 1)[0], 0.25f);
  renderer.setParameter("level", "0.5");
  renderer.render(4);
  EXPECT_EQ(renderer.image().at(2, 1)[0], 0.5f);
  EXPECT_THROW(Program::fromFiles({{"main.rgen", ""}}), UsageError);
  EXPECT_THROW(Program::fromFiles({{"program.toml", "[[ray]]\nnme = \"a\"\n"}}), FileError);
}

TEST(ApiProgram, DiagnosticsNameLines) {
  std::string text = kConstant;
  text.replace(text.find("payload.color * tint"), 20, "payload.colr");
  const Program program = Program::fromSource(text, "wrong");
  const std::vector<Diagnostic> diagnostics = checkProgram(program);
  ASSERT_FALSE(diagnostics.empty());
  EXPECT_EQ(diagnostics[0].severity, Severity::error);
  EXPECT_EQ(diagnostics[0].line, 9);
  EXPECT_THROW(Renderer(device(), Scene::of(program), program), ProgramError);
}

TEST(ApiProgram, BuiltInProgramsCanBeLoaded) {
  const std::vector<std::string> names = Program::builtIn();
  EXPECT_THAT(names, Contains("pathtracer"));
  for (const std::string& name : names) EXPECT_FALSE(Program::load(name).outputs().empty()) << name;
  EXPECT_THROW(Program::load("patracer"), UsageError);
}

TEST(ApiDevice, ListContainsTheOpenDevice) {
  const std::vector<DeviceInfo> all = devices();
  const DeviceInfo used = device().info();
  ASSERT_LT(used.index, all.size());
  EXPECT_EQ(all[used.index].uuid, used.uuid);
  EXPECT_TRUE(all[used.index].usable());
  EXPECT_GT(used.maxRecursionDepth, 0u);
  EXPECT_THROW(Device({.choice = "no such device"}), Error);
}

}  // namespace
}  // namespace quintet::test
