// SPDX-License-Identifier: Apache-2.0
// Heat maps: the counts of known rays, and the same image as without them.
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <numeric>
#include <span>

#include "job/render_job.h"
#include "job/test_engine.h"
#include "program/description/parser.h"
#include "program/heat.h"
#include "program/lecture/lecture.h"
#include "program/load.h"
#include "scene_builder.h"

namespace quintet::job {
namespace {

std::vector<std::string> allHeatMaps() {
  std::vector<std::string> names;
  for (const program::HeatMap& map : program::heatMaps()) names.emplace_back(map.name);
  return names;
}

// A box of two units at the origin, for intersection shaders.
// The ray of pixel 0 hits the box, where another ray starts that hits nothing and skips closest-hit shaders. The rays of
// other pixels hit nothing. Then follow a ray that skips closest-hit shaders, and a trace with mask 0, which is no ray.
constexpr const char* kHeatToml = R"([program]
ray_generation = "main.rgen"
samples_per_launch = 4
any_hit_for_all = true
max_recursion = 2
[[ray]]
name = "primary"
miss = "sky.rmiss"
[[hit_group]]
name = "box"
geometry = "custom"
primary = { closest_hit = "box.rchit", any_hit = "box.rahit", intersection = "box.rint" }
[[output]]
name = "color"
)";
const std::string kVersion =
    "#version 460\n#extension GL_EXT_ray_tracing : require\n#extension GL_EXT_debug_printf : require\n";
const std::map<std::string, std::string> kFiles{
    {"main.rgen", kVersion + R"(#include <quintet/output.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadEXT vec4 payload;
void main() {
  const uvec2 pixel = launchPixel();
  vec4 sum = loadOutput(kOutput_color, pixel);
  for (uint s = 0u; s < launch.sampleCount; ++s) {
    payload = vec4(0.0);
    const vec3 origin = vec3(pixel.x == 0u ? 0.0 : 5.0, 0.0, 5.0);
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary, origin, 0.0,
                vec3(0.0, 0.0, -1.0), 100.0, 0);
    traceRayEXT(topLevelAS, gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary,
                vec3(5.0, 0.0, 5.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 0);
    traceRayEXT(topLevelAS, gl_RayFlagsNoneEXT, 0u, kRay_primary, kRayTypeCount, kMiss_primary, origin, 0.0,
                vec3(0.0, 0.0, -1.0), 100.0, 0);
    sum += vec4(payload.xyz, 1.0);
  }
  storeOutput(kOutput_color, pixel, sum);
}
)"},
    {"sky.rmiss",
     kVersion + "layout(location = 0) rayPayloadInEXT vec4 payload;\nvoid main() { payload = vec4(0.5); }\n"},
    {"box.rchit", kVersion + R"(#include <quintet/frame.glsl>
#include <quintet/generated/program.glsl>
layout(set = 0, binding = kBindingTlas) uniform accelerationStructureEXT topLevelAS;
layout(location = 0) rayPayloadInEXT vec4 payload;
layout(location = 1) rayPayloadEXT vec4 inner;
void main() {
  inner = vec4(0.0);
  traceRayEXT(topLevelAS, gl_RayFlagsSkipClosestHitShaderEXT, 0xFFu, kRay_primary, kRayTypeCount, kMiss_primary,
              vec3(5.0, 0.0, 5.0), 0.0, vec3(0.0, 0.0, -1.0), 100.0, 1);
  payload = vec4(gl_HitTEXT) + inner;
  debugPrintfEXT("hit");
}
)"},
    {"box.rahit", kVersion + "void main() {}\n"},
    {"box.rint", kVersion + "void main() { reportIntersectionEXT(4.0, 0u); }\n"},
};

struct PrintCounter : Observer {
  void printed(const Printed& prints) override { lines += prints.lines.size(); }
  std::size_t lines = 0;
};

class HeatTest : public testing::Test {
 protected:
  static RenderRequest makeRequest(uvec2 size, std::uint64_t samples, const std::vector<std::string>& outputs) {
    RenderRequest request;
    request.size = size;
    request.limits.samples = samples;
    request.outputs = outputs;
    return request;
  }
  RenderResult render(const RenderRequest& request, const program::Program& program) {
    job_ = std::make_unique<RenderJob>(testEngine(), resolve(request, program::withHeatMaps(program, request.outputs)),
                                       observer_);
    return job_->run(request.limits, observer_);
  }
  static RenderRequest boxRequest(std::uint64_t samples) {
    std::vector<std::string> maps = allHeatMaps();
    if (testEngine().context().info().software) std::erase(maps, "heat_time");  // is an error there
    RenderRequest request = makeRequest({2, 1}, samples, maps);
    request.loadedScene = quintet::test::boxScene();
    return request;
  }
  static program::Program boxProgram() { return program::parseProgram(kHeatToml, "box", "box", kFiles); }

  PrintCounter observer_;
  std::unique_ptr<RenderJob> job_;
};

// The values of a heat map.
std::vector<float> valuesOf(const RenderResult& result, const std::string& name) {
  const auto& planes = result.film->planes();
  const auto plane = std::ranges::find(planes, name, &render::FilmPlane::name);
  EXPECT_NE(plane, planes.end()) << name;
  const io::Image image = result.film->image(static_cast<std::size_t>(plane - planes.begin()));
  std::vector<float> values;
  for (std::size_t i = 0; i < image.pixelCount(); ++i) {
    values.push_back(image.samples<float>()[4 * i]);
    EXPECT_EQ(image.samples<float>()[4 * i + 3], 1.0f);
  }
  return values;
}

void expectBoxCounts(const RenderResult& result) {
  using Values = std::vector<float>;
  EXPECT_EQ(valuesOf(result, "heat_rays"), (Values{3, 2}));
  EXPECT_EQ(valuesOf(result, "heat_bounces"), (Values{1, 1}));
  EXPECT_EQ(valuesOf(result, "heat_depth"), (Values{2, 1}));
  EXPECT_EQ(valuesOf(result, "heat_any_hit"), (Values{1, 0}));
  EXPECT_EQ(valuesOf(result, "heat_intersection"), (Values{1, 0}));
  const auto isTime = [](const render::FilmPlane& plane) { return plane.name == "heat_time"; };
  if (std::ranges::any_of(result.film->planes(), isTime)) {
    for (const float ticks : valuesOf(result, "heat_time")) EXPECT_GT(ticks, 0.0f);
  }
}

TEST_F(HeatTest, CountsEachStage) { expectBoxCounts(render(boxRequest(6), boxProgram())); }

TEST_F(HeatTest, CountsWhileTheProgramPrints) {
  RenderRequest request = boxRequest(3);
  request.print.emplace().pixels = {0, 0, 1, 1};
  expectBoxCounts(render(request, boxProgram()));
  EXPECT_EQ(observer_.lines, 3u);
}

// The image has the same bytes, and the rays are those that the program counts itself.
TEST_F(HeatTest, ThePathTracerIsTheSame) {
  for (const bool adaptive : {false, true}) {
    const program::Program program = program::loadProgram("pathtracer");
    RenderRequest request = makeRequest({40, 36}, 8, {});
    request.limits.adaptive = adaptive;
    const std::vector<std::byte> plain = render(request, program).film->image(0).data;
    request.outputs = {"heat_rays", "heat_any_hit"};
    const RenderResult result = render(request, program);
    EXPECT_TRUE(result.film->image(0).data == plain) << adaptive;
    const std::vector<float> rays = valuesOf(result, "heat_rays");
    const double perSample = std::accumulate(rays.begin(), rays.end(), 0.0);
    if (!adaptive) {
      EXPECT_EQ(perSample * 8, static_cast<double>(result.provenance.rays));
    }
    EXPECT_GT(perSample, 40.0 * 36.0);
  }
}

// A program that averages its own frames has the counts of the last frame. The recursion is counted, too.
TEST_F(HeatTest, LectureFormAndRecursion) {
  constexpr const char* kLecture = R"(// gsnShaderOptions: precompiler="GL_EXT_ray_tracing, recursion: 4"
struct RayPayloadType { vec3 color; int level; };
void main() { /**** RAY GENERATION SHADER ****/
  payload.color = vec3(0.0);
  payload.level = 0;
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0, 9.0, 0.0), 0.001, vec3(0.0, -1.0, 0.0), 1000.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}
void main() { /**** MISS SHADER ****/ payload.color = vec3(1.0); }
void main() { /**** CLOSEST-HIT SHADER ****/
  payload.level += 1;
  if (payload.level <= frameID)
    traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0.0, 9.0, 0.0), 0.001, vec3(0.0, -1.0, 0.0), 1000.0, 0);
}
)";
  RenderRequest request = makeRequest({4, 6}, 1, {"heat_depth", "heat_rays"});  // higher than wide
  request.frames.count = 3;
  const RenderResult result = render(request, program::parseLecture(kLecture, "nested.rt.glsl", "here"));
  // In frame 2, the hits of two traces trace again.
  EXPECT_EQ(valuesOf(result, "heat_depth"), std::vector<float>(24, 3.0f));
  EXPECT_EQ(valuesOf(result, "heat_rays"), std::vector<float>(24, 3.0f));
}

}  // namespace
}  // namespace quintet::job
