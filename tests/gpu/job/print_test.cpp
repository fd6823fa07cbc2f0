// SPDX-License-Identifier: Apache-2.0
// debugPrintfEXT in every stage and in both forms of programs: the lines that the observer gets, and the same image as
// without them.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <memory>

#include "base/error.h"
#include "job/pixel_explainer.h"
#include "job/render_job.h"
#include "job/test_engine.h"
#include "program/description/parser.h"
#include "program/heat.h"
#include "program/lecture/lecture.h"
#include "program/load.h"
#include "scene_builder.h"

namespace quintet::job {
namespace {

using testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct PrintObserver : Observer {
  void printed(const Printed& prints) override {
    lines.insert(lines.end(), prints.lines.begin(), prints.lines.end());
    omitted += prints.omitted;
  }
  void printsDisabled() override { ++disabled; }
  void note(const std::string& text) override { notes.push_back(text); }

  std::vector<PrintedLine> lines;
  std::vector<std::string> notes;
  std::uint64_t omitted = 0;
  int disabled = 0;
};

std::vector<std::string> textsOf(const std::vector<PrintedLine>& lines) {
  std::vector<std::string> texts;
  for (const PrintedLine& line : lines) texts.push_back(line.text);
  return texts;
}

// All six stages print. The rays of pixels with x = 0 hit the box, the others miss it.
constexpr const char* kPrintToml = R"([program]
ray_generation = "main.rgen"
samples_per_launch = 4
any_hit_for_all = true
[[ray]]
name = "primary"
miss = "sky.rmiss"
[[hit_group]]
name = "box"
geometry = "custom"
primary = { closest_hit = "box.rchit", any_hit = "box.rahit", intersection = "box.rint" }
[[callable]]
name = "shade"
file = "shade.rcall"
[[output]]
name = "color"
)";

using Files = std::map<std::string, std::string>;

Files files() {
  const std::string version =
      "#version 460\n#extension GL_EXT_ray_tracing : require\n#extension GL_EXT_debug_printf : require\n";
  return {
      {"main.rgen", version + R"(#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
#include "show.glsl"
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT vec4 payload;
layout(location = 0) callableDataEXT vec3 shaded;
void main() {
  const uvec2 pixel = launchPixel();
  vec4 sum = loadOutput(kOutput_color, pixel);
  for (uint s = 0u; s < launch.sampleCount; ++s) {
    debugPrintfEXT("begin %v2u", pixel);
    payload = vec4(0.0);
    const vec3 origin = vec3(pixel.x == 0u ? 0.0 : 5.0, 0.0, 5.0);
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary, origin, 0.0,
                vec3(0.0, 0.0, -1.0), 100.0, 0);
    executeCallableEXT(kCallable_shade, 0);
    SHOW(payload);
    sum += vec4(payload.xyz + shaded, 1.0);
  }
  storeOutput(kOutput_color, pixel, sum);
}
)"},
      {"show.glsl", "void show(vec4 v) {\n  debugPrintfEXT(\"payload %.1v4f\\n\", v);\n}\n#define SHOW(v) show(v)\n"},
      {"sky.rmiss", version + R"(layout(location = 0) rayPayloadInEXT vec4 payload;
void main() {
  payload = vec4(1.0, 2.0, 3.0, 4.0);
  debugPrintfEXT("miss %.1f", gl_WorldRayOriginEXT.x);
}
)"},
      {"box.rchit", version + R"(layout(location = 0) rayPayloadInEXT vec4 payload;
void main() {
  debugPrintfEXT("hit %.1f, primitive %d", gl_HitTEXT, gl_PrimitiveID);
  payload = vec4(gl_HitTEXT);
}
)"},
      {"box.rahit", version + "void main() { debugPrintfEXT(\"candidate %x\", gl_HitKindEXT); }\n"},
      {"box.rint", version + R"(void main() {
  const bool accepted = reportIntersectionEXT(4.0, 0x5Bu);
  debugPrintfEXT("accepted %d", accepted);
}
)"},
      {"shade.rcall", version + R"(layout(location = 0) callableDataInEXT vec3 shaded;
void main() {
  shaded = vec3(0.5);
  debugPrintfEXT("callable %.1v3f", shaded);
}
)"},
  };
}

class PrintTest : public testing::Test {
 protected:
  static RenderRequest makeRequest(uvec2 size, std::uint64_t samples) {
    RenderRequest request;
    request.size = size;
    request.limits.samples = samples;
    return request;
  }
  RenderResult render(const RenderRequest& request, const program::Program& program) {
    job_ = std::make_unique<RenderJob>(testEngine(), resolve(request, program), observer_);
    return job_->run(request.limits, observer_);
  }
  // Renders the six stages.
  RenderResult renderBox(RenderRequest request, const Files& files) {
    request.loadedScene = quintet::test::boxScene();
    return render(request, program::parseProgram(kPrintToml, "box", "box", files));
  }
  RenderResult renderBox(const RenderRequest& request) { return renderBox(request, files()); }

  PrintObserver observer_;
  std::unique_ptr<RenderJob> job_;
};

PrintRequest pixels(std::uint32_t x, std::uint32_t y, std::uint32_t width = 1, std::uint32_t height = 1) {
  PrintRequest request;
  request.pixels = {x, y, width, height};
  return request;
}
PrintRequest allPixels(std::uint64_t limit) {
  PrintRequest request;
  request.all = true;
  request.limit = limit;
  return request;
}

// Stages that do not include the library can use its names for their own declarations, also with prints and heat maps, and
// in an explanation.
TEST_F(PrintTest, StagesCanDeclareTheNamesOfTheLibrary) {
  constexpr const char* kOwnNames = R"(
#define launchPixel 3
const float kPi = 3.0;
const uint kInfinity = 7u;
struct Frame { float textures; };
struct Launch { Frame parameters; };
Launch launch;
float luminance(vec3 c) { return c.x; }
float maxComponent(float frame) { return frame + float(launchPixel); }
float useNames() {
  launch.parameters.textures = 2.0;
  return launch.parameters.textures * kPi + luminance(vec3(4.0)) + maxComponent(float(kInfinity));
}
)";
  Files own = files();
  for (const char* file : {"sky.rmiss", "box.rchit", "box.rahit", "box.rint", "shade.rcall"}) {
    std::string& text = own.at(file);
    const std::size_t main = text.find("void main");
    text.insert(main, kOwnNames);
    text.insert(text.find("{", text.find("void main")) + 1, "\n  debugPrintfEXT(\"own %.0f\", useNames());\n");
  }
  for (const std::vector<std::string>& outputs : {std::vector<std::string>{}, std::vector<std::string>{"heat_rays"}}) {
    RenderRequest request = makeRequest({2, 1}, 1);
    request.loadedScene = quintet::test::boxScene();
    request.print = pixels(0, 0);
    request.outputs = outputs;
    observer_ = {};
    render(request, program::withHeatMaps(program::parseProgram(kPrintToml, "box", "box", own), outputs));
    EXPECT_EQ(std::ranges::count(textsOf(observer_.lines), "own 20"), 4) << outputs.size();
  }
  RenderRequest request = makeRequest({2, 1}, 1);
  request.loadedScene = quintet::test::boxScene();
  const program::Program program = program::parseProgram(kPrintToml, "box", "box", own);
  RenderJob job(testEngine(), resolve(requestForPixel(request, program, {0, 0}), program), observer_);
  const PixelExplanation explanation = PixelExplainer(testEngine(), job).explain({0, 0}, 0, observer_);
  bool hit = false;
  forEachEvent(explanation.events, [&](const ExplainedEvent& event, int) { hit = hit || event.type == "closest-hit"; });
  EXPECT_TRUE(hit);
}

TEST_F(PrintTest, EveryStagePrints) {
  RenderRequest request = makeRequest({2, 1}, 1);
  request.print = pixels(0, 0);
  renderBox(request);
  EXPECT_THAT(textsOf(observer_.lines), ElementsAre("begin 0, 0", "candidate 5b", "accepted 1", "hit 4.0, primitive 0",
                                                    "callable 0.5, 0.5, 0.5", "payload 4.0, 4.0, 4.0, 4.0"));
  const auto& lines = observer_.lines;
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_EQ(lines[0].stage, "main.rgen");
  EXPECT_EQ(lines[0].location.file, "box/main.rgen");
  EXPECT_EQ(lines[0].location.line, 14);
  EXPECT_EQ(lines[1].stage, "box.rahit");
  EXPECT_EQ(lines[1].location.line, 4);
  EXPECT_EQ(lines[5].stage, "main.rgen") << "the function is in an included file";
  EXPECT_EQ(lines[5].location.file, "box/show.glsl");
  EXPECT_EQ(lines[5].location.line, 2);

  observer_.lines.clear();
  request.print = pixels(1, 0);
  renderBox(request);
  EXPECT_THAT(textsOf(observer_.lines),
              ElementsAre("begin 1, 0", "miss 5.0", "callable 0.5, 0.5, 0.5", "payload 1.0, 2.0, 3.0, 4.0"));
  EXPECT_EQ(observer_.disabled, 0);
}

TEST_F(PrintTest, LinesAreSortedByPixelAndSample) {
  RenderRequest request = makeRequest({24, 16}, 3);
  request.print = pixels(20, 12, 2, 2);
  renderBox(request);
  std::vector<std::array<std::uint32_t, 3>> begins;
  for (const PrintedLine& line : observer_.lines)
    if (line.text.starts_with("begin")) begins.push_back({line.pixel.x, line.pixel.y, line.sample.value()});
  using A = std::array<std::uint32_t, 3>;
  EXPECT_THAT(begins, ElementsAre(A{20, 12, 0}, A{20, 12, 1}, A{20, 12, 2}, A{21, 12, 0}, A{21, 12, 1}, A{21, 12, 2},
                                  A{20, 13, 0}, A{20, 13, 1}, A{20, 13, 2}, A{21, 13, 0}, A{21, 13, 1}, A{21, 13, 2}));
  EXPECT_EQ(observer_.lines.size(), 4u * 12);
}

TEST_F(PrintTest, TheCenterIsTheDefault) {
  RenderRequest request = makeRequest({24, 16}, 1);
  request.region = {4, 6, 9, 4};
  request.print.emplace();
  renderBox(request);
  ASSERT_EQ(observer_.lines.size(), 4u);
  EXPECT_EQ(observer_.lines[0].text, "begin 8, 8");
}

TEST_F(PrintTest, TheImageDoesNotChange) {
  RenderRequest request = makeRequest({24, 16}, 6);
  const std::vector<std::byte> plain = renderBox(request).film->image(0).data;
  EXPECT_EQ(observer_.disabled, 1);
  EXPECT_THAT(observer_.lines, IsEmpty());
  request.print = allPixels(10);
  const std::vector<std::byte> printing = renderBox(request).film->image(0).data;
  EXPECT_TRUE(plain == printing);
  EXPECT_EQ(observer_.lines.size(), 10u);
  // 6 samples; of 16 pixels with 6 lines, and of the others with 4.
  EXPECT_EQ(observer_.omitted, 6u * 16 * (6 + 23 * 4) - 10);
}

TEST_F(PrintTest, RecordsThatDoNotFitAreCounted) {
  Files loop = files();
  loop["sky.rmiss"] = R"(#version 460
#extension GL_EXT_ray_tracing : require
#extension GL_EXT_debug_printf : require
layout(location = 0) rayPayloadInEXT vec4 payload;
void main() {
  payload = vec4(0.0);
  for (int i = 0; i < 300000; ++i) debugPrintfEXT("%d", i);
}
)";
  RenderRequest request = makeRequest({2, 1}, 1);
  request.print = pixels(1, 0);
  request.print->limit = 1'000'000;
  renderBox(request, loop);
  EXPECT_EQ(observer_.lines.size() + observer_.omitted, 300'000u + 3);
  EXPECT_GT(observer_.lines.size(), 100'000u);
  EXPECT_GT(observer_.omitted, 100'000u);
  EXPECT_EQ(observer_.lines[100].text, "99") << "the first ones are kept";
}

TEST_F(PrintTest, PixelsOutsideOfTheImageAreAnError) {
  RenderRequest request = makeRequest({24, 16}, 1);
  request.print = pixels(20, 15, 5, 1);
  try {
    renderBox(request);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("20,15,5,1"), HasSubstr("outside"), HasSubstr("0,0,24,16")));
  }
}

TEST_F(PrintTest, AProgramWithoutPrintsGivesANote) {
  RenderRequest request = makeRequest({8, 8}, 1);
  request.print.emplace();
  render(request, program::loadProgram("normals"));
  EXPECT_THAT(observer_.notes, Contains(AllOf(HasSubstr("normals: no shader"), HasSubstr("debugPrintfEXT"))));
  EXPECT_THAT(observer_.lines, IsEmpty());
}

TEST_F(PrintTest, AWrongFormatIsAnErrorOfTheProgram) {
  Files wrong = files();
  wrong["box.rahit"] =
      "#version 460\n#extension GL_EXT_ray_tracing : require\n#extension GL_EXT_debug_printf : require\n"
      "void main() { debugPrintfEXT(\"%f\", gl_HitKindEXT); }\n";
  for (const bool print : {false, true}) {
    RenderRequest request = makeRequest({2, 1}, 1);
    if (print) request.print.emplace();
    try {
      renderBox(request, wrong);
      FAIL();
    } catch (const ProgramError& error) {
      const Diagnostic& d = error.diagnostics().front();
      EXPECT_EQ(d.id, "Q707");
      EXPECT_EQ(d.file, "box/box.rahit");
      EXPECT_EQ(d.line, 4);
      EXPECT_THAT(d.text, HasSubstr("argument 1, which is uint"));
    }
  }
}

// The lecture form: no #extension line is needed, and the program averages its own frames. The mirror recursion counts its
// depth.
constexpr const char* kLecture = R"(// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 3"
struct RayPayloadType { vec3 color; int level; };
void main() { /**** RAY GENERATION SHADER ****/
  payload.color = vec3(0.0);
  payload.level = 0;
  vec3 direction = normalize(vec3(0.0, -1.0, -1.0));
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0, 3.0, 5.0), 0.001, direction, 1000.0, 0);
  if (frameID > 0) debugPrintfEXT("frame %d: %v3f", frameID, payload.color);
  gsnSetPixel(vec4(payload.color, 1.0));
}
void main() { /**** MISS SHADER ****/ payload.color = vec3(1.0); }
void main() { /**** CLOSEST-HIT SHADER ****/
  if (payload.level < 2) {
    payload.level += 1;
    traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, gl_WorldRayOriginEXT + gl_HitTEXT * gl_WorldRayDirectionEXT, 0.001,
                reflect(gl_WorldRayDirectionEXT, vec3(0.0, 1.0, 0.0)), 1000.0, 0);
  }
  debugPrintfEXT("level %d", payload.level);
}
)";

TEST_F(PrintTest, LectureFormAndRecursion) {
  RenderRequest request = makeRequest({8, 8}, 1);
  request.frames.count = 3;
  request.print = pixels(5, 6);
  const program::Program program = program::parseLecture(kLecture, "mirror.rt.glsl", "here");
  render(request, program);
  std::vector<std::string> frames;
  for (const PrintedLine& line : observer_.lines) {
    EXPECT_EQ(line.pixel, uvec2(5, 6));
    EXPECT_FALSE(line.sample);
    if (!line.text.starts_with("frame")) continue;
    frames.push_back(line.text + "/" + std::to_string(line.frame.value()));
    EXPECT_EQ(line.location.line, 8);
    EXPECT_THAT(line.location.file, HasSubstr("mirror.rt.glsl"));
  }
  EXPECT_THAT(frames,
              ElementsAre("frame 1: 1.000000, 1.000000, 1.000000/1", "frame 2: 1.000000, 1.000000, 1.000000/2"));
  EXPECT_THAT(textsOf(observer_.lines), Contains("level 1"));
}

}  // namespace
}  // namespace quintet::job
