// SPDX-License-Identifier: Apache-2.0
// Explanations of samples, and the search for samples, through the API.
#include <gmock/gmock.h>

#include <algorithm>

#include "scenes.h"

namespace quintet::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// The first event of this type, or null.
const Event* findEvent(const std::vector<Event>& events, std::string_view type) {
  for (const Event& event : events) {
    if (event.type == type) return &event;
    if (const Event* child = findEvent(event.children, type)) return child;
  }
  return nullptr;
}

TEST(ApiExplanation, ContributionsSumToTheValueInTheImage) {
  Renderer renderer(device(), lampScene(), pathTracer(), smallImage());
  renderer.render(1);
  const Image image = renderer.image();
  const Explanation explanation = renderer.explain(24, 24);
  EXPECT_EQ(explanation.x, 24u);
  EXPECT_EQ(explanation.y, 24u);
  EXPECT_FALSE(explanation.frames || explanation.discarded);
  ASSERT_FALSE(explanation.contributions.empty());
  Float3 sum{};
  for (const Contribution& contribution : explanation.contributions)
    for (std::size_t i = 0; i < 3; ++i) sum[i] += contribution.value[i];
  ASSERT_FALSE(explanation.outputs.empty());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(explanation.outputs[0].value[i], image.at(24, 24)[i]);
    EXPECT_NEAR(sum[i], image.at(24, 24)[i], 1e-5f);
  }
  const Event* hit = findEvent(explanation.events, "closest-hit");
  ASSERT_TRUE(hit);
  ASSERT_TRUE(hit->get<std::string>("instanceName"));
  EXPECT_EQ(*hit->get<std::string>("instanceName"), "floor");
  EXPECT_FALSE(hit->get<float>("instanceName"));
  EXPECT_FALSE(hit->find("missing"));
  EXPECT_THAT(explanation.text, HasSubstr("Contributions"));
  EXPECT_THAT(explanation.json, HasSubstr("\"format\": \"quintet-explanation\""));
}

TEST(ApiExplanation, KeepsWhatIsRendered) {
  Settings settings = smallImage();
  settings.region = Region{8, 8, 24, 16};
  Renderer renderer(device(), lampScene(), pathTracer(), settings);
  renderer.render(4);
  const Explanation inside = renderer.explain(20, 20, 2), outside = renderer.explain(0, 0, 2);
  EXPECT_EQ(inside.sample, 2u);
  EXPECT_FALSE(outside.events.empty());
  renderer.render(4);
  EXPECT_EQ(renderer.image().pixels, rendered(lampScene(), settings, 8));
}

// The value of a sample and the distance of its first hit. Payloads can have members that the program does not write.
std::vector<float> valueAndDistance(Renderer& renderer) {
  const Explanation explanation = renderer.explain(24, 24);
  std::vector<float> result(explanation.outputs.at(0).value.begin(), explanation.outputs.at(0).value.end());
  const Event* hit = findEvent(explanation.events, "closest-hit");
  result.push_back(hit ? *hit->get<float>("t") : 0.0f);
  return result;
}

TEST(ApiExplanation, FollowsEditsAndFrames) {
  Scene moving = lampScene();
  moving.addInstance(
      {.mesh = 2, .keyframes = {{.frame = 0, .translation = {0, 1, 0}}, {.frame = 10, .translation = {0, 1.4f, 5}}}});
  const Program program = Program::load("normals");
  Renderer edited(device(), moving, program, smallImage());
  const std::vector<float> first = valueAndDistance(edited);
  const Transform below = Transform::translation({0, -1, 0});
  edited.setTransform(0, below);
  const std::vector<float> second = valueAndDistance(edited);
  EXPECT_NE(second, first);
  moving.setTransform(0, below);
  Renderer expected(device(), moving, program, smallImage());
  EXPECT_EQ(second, valueAndDistance(expected));
  edited.setFrame(10);
  const std::vector<float> last = valueAndDistance(edited);
  EXPECT_NE(last, second);
  edited.setFrame(0);
  EXPECT_EQ(valueAndDistance(edited), second);
}

constexpr const char* kPrinting = R"(struct RayPayloadType { vec3 color; };
void main() { /**** RAY GENERATION SHADER ****/
  debugPrintfEXT("frame %d", frameID);
  payload.color = vec3(0.0);
  traceRayEXT(topLevelAS, 0u, 0xFFu, 0u, 0u, 0u, vec3(0, 9, 0), 0.001, vec3(0, -1, 0), 100.0, 0);
  gsnSetPixel(vec4(payload.color, 1.0));
}
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.25 * float(frameID + 1)); }
)";

TEST(ApiExplanation, HasTheLinesOfTheFrame) {
  const Program program = Program::fromSource(kPrinting, "printing");
  Renderer renderer(device(), Scene::of(program), program, {.width = 8, .height = 4});
  const Explanation explanation = renderer.explain(5, 1, 2);
  EXPECT_TRUE(explanation.frames);
  EXPECT_EQ(explanation.sample, 2u);
  ASSERT_EQ(explanation.printed.size(), 1u);
  EXPECT_EQ(explanation.printed[0].text, "frame 2");
  EXPECT_EQ(explanation.printed[0].x, 5u);
  EXPECT_EQ(explanation.printed[0].frame, 2u);
  ASSERT_EQ(explanation.contributions.size(), 1u);
  EXPECT_EQ(explanation.contributions[0].source, "store");
}

constexpr const char* kPrintingTwice = R"(struct RayPayloadType { vec3 color; };
void main() { /**** RAY GENERATION SHADER ****/
  debugPrintfEXT("first");
  debugPrintfEXT("second");
  gsnSetPixel(vec4(1.0));
}
void main() { /**** MISS SHADER ****/ payload.color = vec3(0.0); }
)";

TEST(ApiExplanation, CountsTheLinesBeyondTheLimit) {
  const Program program = Program::fromSource(kPrintingTwice, "printing");
  Renderer renderer(device(), Scene::of(program), program, {.width = 8, .height = 4, .printLimit = 1});
  const Explanation explanation = renderer.explain(5, 1);
  EXPECT_EQ(explanation.printed.size(), 1u);
  EXPECT_EQ(explanation.omittedPrints, 1u);
}

// An edit that rebuilds the scene warns again. The warning is in the next report.
TEST(ApiExplanation, KeepsTheWarningsOfEdits) {
  Scene scene;
  addSquare(scene, {.name = "unused"});
  Renderer renderer(device(), scene, Program::load("normals"), smallImage());
  EXPECT_THAT(renderer.render(4).warnings, ElementsAre(HasSubstr("no surfaces")));
  EXPECT_THAT(renderer.render(4).warnings, ElementsAre());
  renderer.setMaterial(0, {.name = "unused", .baseColor = {1, 1, 1, 0.2f}, .alphaMode = AlphaMode::mask});
  renderer.explain(0, 0);
  EXPECT_THAT(renderer.render(4).warnings, ElementsAre(HasSubstr("no surfaces")));
  renderer.setMaterial(0, {.name = "unused"});
  renderer.search({.samples = 4});
  EXPECT_THAT(renderer.render(4).warnings, ElementsAre(HasSubstr("no surfaces")));
}

TEST(ApiExplanation, SearchesProgramsThatAccumulate) {
  const Program program = Program::fromSource(kPrinting, "printing");
  Renderer renderer(device(), Scene::of(program), program, {.width = 8, .height = 4});
  const SearchReport report = renderer.search();
  EXPECT_EQ(report.samples, SearchSettings{}.samples);
  EXPECT_EQ(report.notFiniteCount, 0u);
  EXPECT_EQ(report.fireflyCount, 0u);
}

TEST(ApiExplanation, SearchFindsFireflies) {
  const Program program =
      constantProgram("(launchPixel() == uvec2(3, 2) && launch.firstSample == 5u ? vec4(90.0) : vec4(0.5))");
  Renderer renderer(device(), lampScene(), program, {.width = 8, .height = 4});
  const SearchReport report = renderer.search({.samples = 8});
  EXPECT_EQ(report.fireflyCount, 1u);
  ASSERT_EQ(report.fireflies.size(), 1u);
  const FoundSample& found = report.fireflies[0];
  EXPECT_EQ(found.x, 3u);
  EXPECT_EQ(found.y, 2u);
  EXPECT_EQ(found.sample, 5u);
  EXPECT_EQ(found.value, (Float3{90, 90, 90}));
  EXPECT_FLOAT_EQ(found.luminance, 90.0f);
  EXPECT_FLOAT_EQ(found.level, 0.5f);
}

TEST(ApiExplanation, RejectsPixelsAndSettingsOutOfRange) {
  Renderer renderer(device(), lampScene(), pathTracer(), smallImage());
  EXPECT_THAT(messageOf([&] { renderer.explain(48, 0); }), HasSubstr("pixel 48,0 is not inside the image of 48x32"));
  EXPECT_THROW(renderer.explain(0, 0, 1u << 24), UsageError);
  EXPECT_THROW(renderer.search({.samples = 0}), UsageError);
  EXPECT_THROW(renderer.search({.samples = (1u << 24) + 1}), UsageError);
  EXPECT_THROW(renderer.search({.samples = 3}), UsageError);
  EXPECT_THROW(renderer.search({.threshold = 0}), UsageError);
}

TEST(ApiExplanation, SearchFindsSamplesThatAreNotFinite) {
  const Program program = constantProgram("(launchPixel() == uvec2(3, 2) ? vec4(sqrt(-hit.t)) : vec4(0.5))");
  Renderer renderer(device(), lampScene(), program, {.width = 8, .height = 4});
  double last = 0;
  const SearchReport report = renderer.search({.samples = 6, .limit = 2}, [&](const Progress& progress) {
    last = std::max(last, progress.samples);  // of the search, then of the explanations
    return true;
  });
  EXPECT_EQ(last, 6.0);
  EXPECT_EQ(report.samples, 6u);
  EXPECT_EQ(report.notFiniteCount, 6u);
  EXPECT_EQ(report.fireflyCount, 0u);
  EXPECT_FALSE(report.canceled);
  ASSERT_EQ(report.notFinite.size(), 1u) << "one group of pixels";
  const FoundSample& found = report.notFinite[0];
  EXPECT_EQ(found.x, 3u);
  EXPECT_EQ(found.y, 2u);
  EXPECT_EQ(found.sample, 0u);
  EXPECT_EQ(found.event, "store");
  EXPECT_EQ(found.field, "value");
  EXPECT_EQ(found.pixels, 1u);
  EXPECT_EQ(found.samples, 6u);
  EXPECT_EQ(found.firstX, 3u);
  EXPECT_EQ(found.lastY, 2u);
  const SearchReport canceled = renderer.search({.samples = 6}, [](const Progress&) { return false; });
  EXPECT_TRUE(canceled.canceled);
  EXPECT_EQ(canceled.samples, 1u);
  EXPECT_EQ(canceled.notFinite.size(), 1u);
}

}  // namespace
}  // namespace quintet::test
