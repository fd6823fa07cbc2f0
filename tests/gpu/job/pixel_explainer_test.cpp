// SPDX-License-Identifier: Apache-2.0
// What quintet explain-pixel records on the device: the values are those of the program, the contributions of each
// built-in program sum to them, and the events are those of the shaders.
#include "job/pixel_explainer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <variant>

#include "../render/scene_builder.h"
#include "base/error.h"
#include "infinite_sky.h"
#include "job/explanation_json.h"
#include "job/test_engine.h"
#include "program/lecture/lecture.h"
#include "program/load.h"

namespace quintet::job {
namespace {

RenderRequest smallRequest() {
  RenderRequest request;
  request.size = {64, 48};
  request.limits.samples = 8;
  request.frames.accumulated = 8;
  return request;
}

PixelExplanation explain(const program::Program& program, uvec2 pixel, std::uint32_t sample,
                         RenderRequest request = smallRequest()) {
  Observer observer;
  RenderJob job(testEngine(), resolve(requestForPixel(std::move(request), program, pixel), program), observer);
  return PixelExplainer(testEngine(), job).explain(pixel, sample, observer);
}

// The sum of the first samples of a pixel.
vec4 renderedSum(const program::Program& program, uvec2 pixel, std::uint32_t samples) {
  RenderRequest request = smallRequest();
  request.region = {pixel.x, pixel.y, 1, 1};
  Observer observer;
  RenderJob job(testEngine(), resolve(std::move(request), program), observer);
  RenderLimits limits;
  limits.samples = samples;
  job.run(limits, observer);
  const io::Image image = job.renderer().film().download(0);
  const auto pixels = image.samples<float>();
  return vec4(pixels[0], pixels[1], pixels[2], pixels[3]) * static_cast<float>(samples);
}

void expectNear(const vec3& a, const vec3& b, float tolerance, const std::string& what) {
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(a[i], b[i], tolerance * std::max(1.0f, std::max(std::abs(a[i]), std::abs(b[i])))) << what;
}

std::vector<const ExplainedEvent*> eventsOf(const PixelExplanation& explanation, std::string_view type) {
  std::vector<const ExplainedEvent*> found;
  forEachEvent(explanation.events, [&](const ExplainedEvent& event, int) {
    if (event.type == type) found.push_back(&event);
  });
  return found;
}

// Expects that each text is read as a text, whatever it is. Members of payloads that a program does not write can be NaN,
// which equals nothing.
void expectTextsInJson(PixelExplanation e, const std::string& what) {
  const auto replace = [](const auto& self, std::vector<ExplainedEvent>& events) -> void {
    for (ExplainedEvent& event : events) {
      for (auto& [name, value] : event.fields) {
        if (name != "hitKind" && std::holds_alternative<std::string>(value)) value = std::string("nan");
        if (auto* number = std::get_if<float>(&value); number && std::isnan(*number)) *number = 0.0f;
        if (auto* numbers = std::get_if<std::vector<float>>(&value))
          for (float& number : *numbers) number = std::isnan(number) ? 0.0f : number;
      }
      self(self, event.children);
    }
  };
  replace(replace, e.events);
  EXPECT_TRUE(parseExplanation(explanationJson(e), "e.json").events == e.events) << what;
}

class ExplainedPrograms : public testing::TestWithParam<const char*> {};

// For some pixels and samples: the instrumented program computes what the program computes, and the contributions sum to
// the value of the sample.
TEST_P(ExplainedPrograms, SumContributionsToTheValue) {
  const program::Program program = program::loadProgram(GetParam());
  RenderRequest request = smallRequest();
  Observer observer;
  request.region = {20, 14, 24, 20};
  RenderJob job(testEngine(), resolve(std::move(request), program), observer);
  PixelExplainer explainer(testEngine(), job);
  float largest = 0.0f;
  for (const uvec2 pixel : {uvec2(20, 14), uvec2(32, 24), uvec2(27, 30), uvec2(43, 33), uvec2(38, 20)}) {
    for (const std::uint32_t sample : {0u, 3u}) {
      const PixelExplanation e = explainer.explain(pixel, sample, observer);
      const std::string what = std::string(GetParam()) + " pixel " + std::to_string(pixel.x) + "," +
                               std::to_string(pixel.y) + " sample " + std::to_string(sample);
      ASSERT_FALSE(e.outputs.empty()) << what;
      EXPECT_FALSE(e.discarded) << what;
      EXPECT_EQ(e.lostRecords, 0u) << what;
      EXPECT_FALSE(eventsOf(e, "store").empty()) << what;
      expectTextsInJson(e, what);
      const vec3 value = e.outputs[0].value;
      expectNear(e.outputs[0].recorded, value, 1e-5f, what + ": recorded");
      expectNear(sumContributions(e), value, 1e-5f, what + ": sum");
      largest = std::max({largest, value.x, value.y, value.z});
    }
  }
  EXPECT_GT(largest, 0.0f) << "all values are black";
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, ExplainedPrograms,
                         testing::Values("pathtracer", "naive", "ao", "normals", "01_first_ray", "02_cameras",
                                         "03_mesh_data", "04_diffuse", "05_shadow", "06_mirror_loop",
                                         "07_mirror_recursion", "08_refraction", "09_progressive", "10_sphere",
                                         "11_many_spheres", "12_box", "13_triangle", "14_csg", "14_csg_tree",
                                         "15_any_hit", "16_callable", "17_records", "18_instances", "19_dynamic",
                                         "20_lambert", "21_one_weekend", "22_path_tracer"),
                         [](const auto& test) { return "P" + std::string(test.param); });

// The values of all samples, explained one by one, sum to the film.
TEST(PixelExplainer, ExplainsTheSamplesOfTheRender) {
  for (const char* name : {"pathtracer", "ao"}) {
    const program::Program program = program::loadProgram(name);
    vec3 sum(0.0f);
    RenderRequest request = smallRequest();
    Observer observer;
    const uvec2 pixel(32, 24);
    RenderJob job(testEngine(), resolve(requestForPixel(std::move(request), program, pixel), program), observer);
    PixelExplainer explainer(testEngine(), job);
    for (std::uint32_t sample = 0; sample < 8; ++sample)
      sum += vec3(explainer.explain(pixel, sample, observer).outputs[0].value);
    expectNear(sum, renderedSum(program, pixel, 8), 1e-4f, name);
  }
}

TEST(PixelExplainer, ExplainsFramesAfterTheEarlierOnes) {
  const program::Program program = program::loadProgram("09_progressive");
  RenderRequest request = smallRequest();
  Observer observer;
  RenderJob job(testEngine(), resolve(request, program), observer);
  RenderJob rendered(testEngine(), resolve(request, program), observer);
  PixelExplainer explainer(testEngine(), job);
  std::vector<vec4> frames[3];
  for (std::uint32_t frame = 0; frame < 3; ++frame) {
    rendered.renderer().renderFrame(frame);
    rendered.renderer().finish();
    frames[frame] = rendered.renderer().film().plane(0).values;
  }
  bool differs = false;
  for (std::uint32_t x = 14; x < 50; x += 6) {
    const PixelExplanation e = explainer.explain({x, 24}, 2, observer);
    EXPECT_TRUE(e.frames);
    const std::size_t i = 24 * 64 + x;
    expectNear(e.outputs[0].value, frames[2][i], 1e-6f, "frame 2");
    expectNear(explainer.explain({x, 24}, 0, observer).outputs[0].value, frames[0][i], 1e-6f, "frame 0");
    differs = differs || frames[0][i] != frames[2][i];
  }
  EXPECT_TRUE(differs) << "the frames of all pixels are equal";
}

// Returns the contributions of light samples whose radiance the medium reduces.
int checkNumbers(const PixelExplanation& e, const vec3& emitted) {
  const ExplainedEvent* light = nullptr;
  const ExplainedEvent* shadow = nullptr;
  const ExplainedEvent* emission = nullptr;
  int absorbed = 0;
  for (const ExplainedEvent& event : e.events) {
    if (event.type == "light" && event.find("pdf")) {
      light = &event;
      EXPECT_NE(light->text("light"), "none");
      EXPECT_GT(light->number("probability"), 0.0f);
      EXPECT_LE(light->number("probability"), 1.0f);
    }
    if (event.type == "ray" && event.text("rayType") == "shadow") shadow = &event;
    if (event.type == "emission") emission = &event;
    if (event.type != "contribution") continue;
    vec3 expected(0.0f);
    if (event.text("source") == "light sample") {
      EXPECT_TRUE(light && shadow);
      if (!light || !shadow) continue;
      expected = light->vector("throughput") * light->vector("bsdf") * light->vector("radiance") *
                 (light->number("misWeight") / light->number("pdf")) * shadow->vector("transmittance");
      const float a = light->number("pdf"), b = light->number("bsdfPdf");
      EXPECT_NEAR(light->number("misWeight"), light->flag("delta") ? 1.0f : a / (a + b), 1e-5f);
      if (light->vector("radiance").r < 0.99f * emitted.r) ++absorbed;
    } else {
      EXPECT_TRUE(emission);
      if (!emission) continue;
      expected = emission->number("misWeight") * emission->vector("throughput") * emission->vector("radiance");
    }
    expectNear(event.vector("value"), expected, 1e-5f, event.text("source"));
  }
  return absorbed;
}

// Next-event estimation: the value of each contribution follows from the numbers of the events before it.
TEST(PixelExplainer, StatesTheNumbersOfThePathTracer) {
  const PixelExplanation e = explain(program::loadProgram("pathtracer"), {32, 30}, 1);
  EXPECT_FALSE(eventsOf(e, "contribution").empty());
  checkNumbers(e, vec3(0.0f));
}

// A lamp in a block of rough absorbing glass: the light of samples at its surface passes the glass.
TEST(PixelExplainer, StatesTheNumbersInAbsorbingMedia) {
  quintet::test::SceneBuilder builder;
  scene::Material glass = quintet::test::clearGlass(1.3f, 1.0f);
  glass.roughness = 0.6f;
  glass.attenuationColor = {0.2f, 0.5f, 0.8f};
  glass.attenuationDistance = 0.5f;
  const vec3 emitted(9.0f, 7.0f, 5.0f);
  builder.add(quintet::test::box({-0.8f, -0.6f, -0.6f}, {0.8f, 0.6f, 0.8f}), glass);
  builder.add(quintet::test::quad({-0.4f, -0.3f, 0.0f}, {0.8f, 0, 0}, {0, 0.6f, 0}), quintet::test::emitter(emitted));
  builder.camera(quintet::test::perspective({0, 0, 4}, {0, 0, 0}, 40.0f));
  RenderRequest request = smallRequest();
  request.loadedScene = std::make_shared<scene::Scene>(std::move(builder.scene));
  request.environment.source = "none";
  const program::Program program = program::loadProgram("pathtracer");
  Observer observer;
  RenderJob job(testEngine(), resolve(requestForPixel(std::move(request), program, {32, 24}), program), observer);
  PixelExplainer explainer(testEngine(), job);
  int absorbed = 0;
  for (std::uint32_t sample = 0; sample < 8; ++sample)
    absorbed += checkNumbers(explainer.explain({32, 24}, sample, observer), emitted);
  EXPECT_GT(absorbed, 0) << "no light sample passes the glass";
}

// Left, the back of an unlit panel; right, the front of a panel that scatters light.
TEST(PixelExplainer, StatesSidesAndUnlitSurfaces) {
  quintet::test::SceneBuilder builder;
  builder.add(quintet::test::quad({-2, -2, 0}, {0, 4, 0}, {2, 0, 0}), quintet::test::unlit(vec3(0.5f)));
  builder.add(quintet::test::quad({0, -2, 0}, {2, 0, 0}, {0, 4, 0}), quintet::test::lambert(vec3(0.5f)));
  builder.sky(vec3(1.0f)).camera(quintet::test::perspective({0, 0, 4}, {0, 0, 0}, 40.0f));
  RenderRequest request = smallRequest();
  request.loadedScene = std::make_shared<scene::Scene>(std::move(builder.scene));
  for (const bool left : {true, false}) {
    const PixelExplanation e = explain(program::loadProgram("pathtracer"), {left ? 24 : 40, 24}, 0, request);
    const auto surfaces = eventsOf(e, "surface"), shadings = eventsOf(e, "shading"), ends = eventsOf(e, "end");
    ASSERT_FALSE(surfaces.empty() || shadings.empty());
    EXPECT_EQ(surfaces[0]->text("side"), left ? "back" : "front");
    EXPECT_EQ(!ends.empty() && ends[0]->text("reason") == "unlit surface", left);
    EXPECT_EQ(shadings[0]->flag("unlit"), left);
    EXPECT_EQ(shadings[0]->vector("baseColor"), vec3(0.5f));
  }
}

// A lamp that reflects nothing.
TEST(PixelExplainer, StatesThatADirectionIsOfNoUse) {
  quintet::test::SceneBuilder builder;
  builder.add(quintet::test::quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), quintet::test::emitter(vec3(2.0f)));
  builder.camera(quintet::test::perspective({0, 0, 4}, {0, 0, 0}, 40.0f));
  RenderRequest request = smallRequest();
  request.loadedScene = std::make_shared<scene::Scene>(std::move(builder.scene));
  request.environment.source = "none";
  const PixelExplanation e = explain(program::loadProgram("pathtracer"), {32, 24}, 0, request);
  const auto samples = eventsOf(e, "bsdf");
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_FALSE(samples[0]->flag("useful"));
  EXPECT_EQ(samples[0]->find("direction"), nullptr);
  EXPECT_EQ(vec3(e.outputs[0].value), vec3(2.0f));
}

// Without MIS and clamping, the numbers of a contribution are those of the path alone.
TEST(PixelExplainer, StatesTheNumbersOfNaive) {
  std::size_t contributions = 0;
  for (std::uint32_t sample = 0; sample < 4; ++sample) {
    const PixelExplanation e = explain(program::loadProgram("naive"), {32, 30}, sample);
    std::int64_t scatterings = 0;
    for (const ExplainedEvent& event : e.events) {
      if (event.type == "bsdf" && event.find("straight")) scatterings += event.flag("straight") ? 0 : 1;
      if (event.type != "contribution") continue;
      EXPECT_EQ(event.find("unclamped"), nullptr);
      EXPECT_EQ(event.integer("scatterings"), scatterings);
      ++contributions;
    }
    for (const ExplainedEvent* event : eventsOf(e, "emission")) {
      EXPECT_EQ(event->number("bsdfPdf"), 0.0f);
      EXPECT_EQ(event->number("misWeight"), 1.0f);
    }
  }
  EXPECT_GT(contributions, 0u);
}

// A ray that skips the closest-hit shader still reports its hit.
TEST(PixelExplainer, ReportsHitsOfShadowRays) {
  const program::Program program = program::loadProgram("ao");
  Observer observer;
  RenderRequest request = smallRequest();
  request.region = {24, 16, 16, 24};
  RenderJob job(testEngine(), resolve(std::move(request), program), observer);
  PixelExplainer explainer(testEngine(), job);
  PixelExplanation e;
  std::vector<const ExplainedEvent*> rays;
  for (std::uint32_t i = 0; i < 32 && !(rays.size() == 2 && rays[1]->text("result") == "hit"); ++i) {
    e = explainer.explain({24 + i % 4 * 5, 16 + i / 4 * 3}, i, observer);
    rays = eventsOf(e, "ray");
  }
  ASSERT_EQ(rays.size(), 2u);
  EXPECT_EQ(rays[0]->text("rayType"), "radiance");
  EXPECT_EQ(rays[0]->text("result"), "hit");
  EXPECT_EQ(rays[0]->children[1].type, "closest-hit");
  EXPECT_EQ(rays[1]->text("flags"), "TerminateOnFirstHit SkipClosestHitShader");
  ASSERT_EQ(rays[1]->text("result"), "hit") << "no occluded sample";
  const std::vector<const ExplainedEvent*> hits = eventsOf(e, "hit");
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_EQ(hits[0], &rays[1]->children[1]);
  EXPECT_EQ(hits[0]->find("stage"), nullptr);
  EXPECT_GT(hits[0]->number("t"), 0.0f);
  EXPECT_NE(hits[0]->text("instanceName"), "");
}

const char* kTracer = R"(
struct RayPayloadType { vec3 color; int depth; bool inside; };
struct CallableDataType { float x; uvec2 n; };
void main() { /**** RAY GENERATION SHADER ****/
  payload.color = vec3(0.25); payload.depth = 3; payload.inside = true;
  traceRayEXT(topLevelAS, gl_RayFlagsOpaqueEXT, 0xFFu, 0u, 0u, 0u, vec3(2.2, 2.6, 6.0), 0.5, vec3(-0.33, -0.27, -0.9), 100.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}
void main() { /**** CLOSEST-HIT SHADER ****/
  payload.depth++;
  callableData.x = gl_HitTEXT; callableData.n = uvec2(1u, 2u);
  executeCallableEXT(0u, 0);
  payload.color = vec3(callableData.x);
}
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); payload.inside = false; }
void main() { /**** CALLABLE SHADER ****/ callableData.x = 0.5; callableData.n.y = 7u; }
)";

TEST(PixelExplainer, RecordsPayloadsAndCallsOfUserPrograms) {
  const program::Program program = program::parseLecture(kTracer, "demo.rt.glsl", "here");
  RenderRequest request = smallRequest();
  const PixelExplanation e = explain(program, {5, 6}, 0, request);
  const std::vector<const ExplainedEvent*> rays = eventsOf(e, "ray");
  ASSERT_EQ(rays.size(), 1u);
  const ExplainedEvent& ray = *rays[0];
  EXPECT_EQ(ray.vector("origin"), vec3(2.2f, 2.6f, 6.0f));
  EXPECT_EQ(ray.vector("direction"), vec3(-0.33f, -0.27f, -0.9f));
  EXPECT_EQ(ray.number("tmin"), 0.5f);
  EXPECT_EQ(ray.number("tmax"), 100.0f);
  EXPECT_EQ(ray.text("flags"), "Opaque");
  EXPECT_EQ(ray.integer("line"), 6);
  ASSERT_FALSE(ray.children.empty());
  const ExplainedEvent& before = ray.children.front();
  EXPECT_EQ(before.type, "payload");
  EXPECT_EQ(before.vector("payload.color"), vec3(0.25f));
  EXPECT_EQ(before.integer("payload.depth"), 3);
  EXPECT_TRUE(before.flag("payload.inside"));
  const ExplainedEvent& after = ray.children.back();
  EXPECT_EQ(after.text("when"), "after");
  const std::vector<const ExplainedEvent*> calls = eventsOf(e, "call");
  ASSERT_EQ(ray.text("result"), "hit") << "the ray misses the built-in scene";
  EXPECT_EQ(after.vector("payload.color"), vec3(0.5f));
  EXPECT_EQ(after.integer("payload.depth"), 4);
  ASSERT_EQ(calls.size(), 1u);
  EXPECT_EQ(calls[0]->children.front().number("callableData.x"), eventsOf(e, "closest-hit")[0]->number("t"));
  EXPECT_EQ(*calls[0]->children.back().find("callableData.n"), EventValue(std::vector<std::int64_t>{1, 7}));
  EXPECT_EQ(calls[0]->children[1].type, "callable");
  EXPECT_EQ(vec3(e.outputs[0].value), after.vector("payload.color"));
}

// A hit group without closest-hit shader.
TEST(PixelExplainer, ReportsHitsWithoutShader) {
  program::Program program = program::parseLecture(kTracer, "demo.rt.glsl", "here");
  for (program::HitGroup& group : program.hitGroups)
    for (auto& [ray, shaders] : group.shaders) shaders.closestHit.clear();
  const PixelExplanation e = explain(program, {5, 6}, 0);
  const std::vector<const ExplainedEvent*> hits = eventsOf(e, "hit");
  ASSERT_EQ(hits.size(), 1u);
  EXPECT_EQ(hits[0]->find("stage"), nullptr);
  EXPECT_EQ(eventsOf(e, "ray")[0]->text("result"), "hit");
  EXPECT_TRUE(eventsOf(e, "closest-hit").empty());
  EXPECT_EQ(vec3(e.outputs[0].value), vec3(0.25f)) << "no shader changed the payload";
}

TEST(PixelExplainer, RecordsLargePayloads) {
  const char* text = R"(
struct RayPayloadType { float values[300]; vec3 color; };
void main() { /**** RAY GENERATION SHADER ****/
  for (int i = 0; i < 300; ++i) payload.values[i] = float(i);
  payload.color = vec3(0.25);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 90, 0), 0.5, vec3(0, 1, 0), 100.0, 0);
  gsnSetPixel(vec4(payload.color, payload.values[299]));
}
void main() { /**** MISS SHADER ****/ payload.values[299] = 0.5; payload.color = vec3(0.75); }
)";
  const PixelExplanation e = explain(program::parseLecture(text, "large.rt.glsl", "here"), {5, 6}, 0);
  const std::vector<const ExplainedEvent*> payloads = eventsOf(e, "payload");
  ASSERT_EQ(payloads.size(), 2u);
  EXPECT_EQ(payloads[0]->number("payload.values[298]"), 298.0f);
  EXPECT_EQ(payloads[0]->number("payload.values[299]"), 299.0f);
  EXPECT_EQ(payloads[1]->number("payload.values[299]"), 0.5f);
  EXPECT_EQ(payloads[1]->vector("payload.color"), vec3(0.75f));
  EXPECT_FALSE(payloads[1]->find("complete"));
}

// Three renderers bind the images: that of the job, and two that explain.
TEST(PixelExplainer, ExplainsProgramsWithManyImages) {
  program::Program program = program::loadProgram("normals");
  for (int i = 0; i < 40; ++i) {
    program::Parameter& parameter = program.parameters.emplace_back();
    parameter.name = "image" + std::to_string(i);
    parameter.type = program::ParameterType::image;
  }
  Observer observer;
  RenderJob job(testEngine(), resolve(requestForPixel(smallRequest(), program, {32, 24}), program), observer);
  const ExplainedImage image{{job.scene()->camera, job.scene()->cameraDescription}, job.scene()->size};
  EXPECT_FALSE(PixelExplainer(testEngine(), job, image, {32, 24}).explain({32, 24}, 0, observer).events.empty());
}

TEST(PixelExplainer, RecordsCandidates) {
  const PixelExplanation any = explain(program::loadProgram("15_any_hit"), {32, 24}, 0);
  const PixelExplanation box = explain(program::loadProgram("10_sphere"), {32, 24}, 0);
  const std::vector<const ExplainedEvent*> intersections = eventsOf(box, "intersection");
  ASSERT_FALSE(intersections.empty());
  ASSERT_FALSE(eventsOf(box, "report").empty());
  const ExplainedEvent& report = *eventsOf(box, "report").front();
  const std::vector<const ExplainedEvent*> hits = eventsOf(box, "closest-hit");
  ASSERT_FALSE(hits.empty());
  EXPECT_TRUE(report.flag("accepted"));
  EXPECT_EQ(report.number("t"), hits[0]->number("t"));
  bool ignored = false;
  for (std::uint32_t x = 8; x < 56 && !ignored; x += 4) {
    const PixelExplanation explanation = explain(program::loadProgram("15_any_hit"), {x, 24}, 0);
    for (const ExplainedEvent* e : eventsOf(explanation, "any-hit"))
      ignored = ignored || e->text("result") == "ignored";
  }
  EXPECT_TRUE(ignored) << "no candidate was ignored";
}

TEST(PixelExplainer, NestsTheRaysOfRecursion) {
  const PixelExplanation e = explain(program::loadProgram("07_mirror_recursion"), {32, 24}, 0);
  int deepest = 0;
  forEachEvent(e.events, [&](const ExplainedEvent& event, int depth) {
    if (event.type == "ray") deepest = std::max(deepest, depth);
  });
  EXPECT_GE(deepest, 2) << "no ray was traced in a closest-hit shader";
}

TEST(PixelExplainer, StatesThatASampleWasDiscarded) {
  RenderRequest request = smallRequest();
  request.environment.source = "2,2,2";
  const quintet::test::InfiniteSky program;
  const PixelExplanation e = explain(program::loadProgram(program.path()), {32, 0}, 0, request);
  EXPECT_TRUE(e.discarded);
  EXPECT_EQ(e.outputs[0].value, vec4(0.0f)) << "nothing was added";
  EXPECT_TRUE(std::isinf(sumContributions(e).x));
}

TEST(PixelExplainer, RejectsRequestsWithoutASinglePixel) {
  const program::Program program = program::loadProgram("ao");
  RenderRequest request;
  request.region = {0, 0, 2, 2};
  EXPECT_THROW(requestForPixel(request, program, {0, 0}), UsageError);
  request.region = {};
  request.batches = BatchRange{0, 1};
  EXPECT_THROW(requestForPixel(request, program, {0, 0}), UsageError);
  request.batches.reset();
  EXPECT_EQ(requestForPixel(request, program, {3, 4}).region, (render::Region{3, 4, 1, 1}));
}

TEST(PixelExplainer, RejectsSamplesAboveTheLimit) {
  EXPECT_THROW(explain(program::loadProgram("normals"), {0, 0}, kMaxSample + 1), UsageError);
}

// Without a size in the request, the size of the image follows from the camera.
TEST(PixelExplainer, RejectsPixelsOutsideOfTheImage) {
  const auto problem = [](const program::Program& program) -> std::string {
    RenderRequest request = smallRequest();
    request.size = {64, 0};
    try {
      explain(program, {5, 5000}, 0, request);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(problem(program::loadProgram("ao")), testing::StartsWith("pixel 5,5000 is not inside the image of 64x"));
  // A program that can read other pixels renders all of them.
  const std::string text = std::string("// loadPrevious\n") + kTracer;
  const program::Program whole = program::parseLecture(text, "demo.rt.glsl", "here");
  ASSERT_EQ(requestForPixel(smallRequest(), whole, {5, 6}).region.width, 0u);
  EXPECT_THAT(problem(whole), testing::StartsWith("pixel 5,5000 is not inside the image of 64x"));
}

}  // namespace
}  // namespace quintet::job
