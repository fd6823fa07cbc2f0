// SPDX-License-Identifier: Apache-2.0
// What is reported about a finished render.
#include "job/result.h"

#include <gmock/gmock.h>

#include <limits>

namespace quintet::job {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RenderResult missedTarget() {
  RenderResult result;
  result.provenance.targetError = 0.02;
  result.provenance.samples = 64;
  result.error.upper = 0.05;
  result.error.tiles = 0.125;
  result.targetMissed = true;
  return result;
}

TEST(ResultWarnings, NoneForACompleteRender) {
  RenderResult result = missedTarget();
  result.targetMissed = false;
  EXPECT_THAT(resultWarnings(result), IsEmpty());
}

TEST(ResultWarnings, ReportAMissedTarget) {
  EXPECT_THAT(resultWarnings(missedTarget()),
              ElementsAre(AllOf(HasSubstr("2 %"), HasSubstr("5 %"), HasSubstr("12 %"))));
}

TEST(ResultWarnings, ReportWhyTheErrorIsUnknown) {
  RenderResult result = missedTarget();
  result.provenance.samples = render::kBatchSamples;
  EXPECT_THAT(resultWarnings(result), ElementsAre(HasSubstr("two batches")));
  result.provenance.samples = 64;
  result.error.upper = std::numeric_limits<double>::infinity();
  EXPECT_THAT(resultWarnings(result), ElementsAre(HasSubstr("range of the film")));
}

TEST(ResultWarnings, AnInterruptedRenderIsExpectedToMissItsTarget) {
  RenderResult result = missedTarget();
  result.interrupted = true;
  EXPECT_THAT(resultWarnings(result), IsEmpty());
}

TEST(ResultWarnings, OfABlackImageOfThePathTracer) {
  const auto warningsOf = [](const char* program, const vec4& color) {
    render::FilmState film;
    film.region.width = 2;
    film.region.height = 1;
    film.planes.emplace_back();
    film.planes[0].pixel = program::OutputPixel::center;
    film.planes[0].values = {vec4(0, 0, 0, 1), color};
    RenderResult result;
    result.provenance.program = program;
    result.film = viewOf(std::move(film), false);
    return resultWarnings(result);
  };
  EXPECT_THAT(warningsOf("pathtracer", vec4(0, 0, 0, 1)), ElementsAre(HasSubstr("black")));
  EXPECT_THAT(warningsOf("pathtracer", vec4(0, 1e-6f, 0, 1)), ElementsAre(HasSubstr("nearly")));
  EXPECT_THAT(warningsOf("pathtracer", vec4(0, 0.001f, 0, 1)), IsEmpty());
  EXPECT_THAT(warningsOf("pathtracer", vec4(0)), ElementsAre(HasSubstr("black"))) << "the other pixel is covered";
  EXPECT_THAT(warningsOf("depth", vec4(0, 0, 0, 1)), IsEmpty());
}

TEST(ResultWarnings, CountDiscardedSamples) {
  RenderResult result;
  result.provenance.droppedSamples = 1;
  EXPECT_THAT(resultWarnings(result), ElementsAre(HasSubstr("1 sample was")));
  result.provenance.droppedSamples = 3;
  EXPECT_THAT(resultWarnings(result), ElementsAre(HasSubstr("3 samples were")));
  setCounts(result, {100, 12, {34, 120}}, {});
  EXPECT_THAT(
      resultWarnings(result),
      ElementsAre("12 samples were not finite and are omitted; the first is at pixel (34, 120), counted from the "
                  "top left corner"));
}

TEST(ResultWarnings, CountPixelsThatAreNotFinite) {
  RenderResult result;
  setCounts(result, {}, {{"color", 3, {34, 120}}, {"depth", 1, {0, 7}}});
  EXPECT_THAT(
      resultWarnings(result),
      ElementsAre("3 pixels of the output 'color' are not finite; the first is at pixel (34, 120), counted from "
                  "the top left corner; see 'quintet explain Q002'",
                  AllOf(HasSubstr("1 pixel of"), HasSubstr("'depth' is not finite; it is at"), HasSubstr("(0, 7)"))));
  EXPECT_EQ(result.provenance.notFinitePixels, 4u);
  EXPECT_EQ(result.provenance.firstNotFinitePixel, (PixelPosition{34, 120}));
  result.accumulatesFrames = true;
  EXPECT_THAT(
      resultWarnings(result),
      ElementsAre(
          AllOf(HasSubstr("3 pixels of"), HasSubstr("'color' were not finite in at least one frame; the first")),
          AllOf(HasSubstr("1 pixel of"), HasSubstr("'depth' was not finite in at least one frame; it is"))));
  setCounts(result, {}, {});
  EXPECT_THAT(resultWarnings(result), IsEmpty());
}

TEST(RunFindings, HaveTheIdOfTheirPageAndNoCommand) {
  RenderResult result = missedTarget();
  setCounts(result, {100, 2, {5, 6}}, {{"color", 3, {34, 120}}});
  result.skippedTraces = 1;
  result.recursionDepth = 3;
  const std::vector<Diagnostic> findings = runFindings(result);
  ASSERT_EQ(findings.size(), 3u);
  EXPECT_EQ(findings[0].id, "");
  EXPECT_THAT(findings[0].text, HasSubstr("2 samples were not finite"));
  EXPECT_EQ(findings[1].id, "Q002");
  EXPECT_EQ(findings[1].text,
            "3 pixels of the output 'color' are not finite; the first is at pixel (34, 120), counted from the top left "
            "corner");
  EXPECT_EQ(findings[2].id, "Q003");
  EXPECT_EQ(findings[2].text, "1 trace was deeper than the recursion depth 3 of the pipeline and was not executed");
  for (const Diagnostic& finding : findings) EXPECT_EQ(finding.severity, Severity::warning);
  EXPECT_THAT(resultWarnings(result).back(), HasSubstr("not executed; see 'quintet explain Q003'"));
}

TEST(ResultWarnings, AddUpFrames) {
  RenderResult sum, frame;
  setCounts(sum, {5, 1, {3, 4}}, {{"color", 2, {8, 1}}});
  setCounts(frame, {5, 2, {9, 3}}, {{"color", 3, {1, 1}}, {"depth", 1, {0, 0}}});
  addFrame(sum, frame);
  EXPECT_EQ(sum.provenance.rays, 10u);
  EXPECT_EQ(sum.provenance.droppedSamples, 3u);
  EXPECT_EQ(sum.provenance.firstDroppedSample, (PixelPosition{9, 3}));
  EXPECT_THAT(sum.notFinite,
              ElementsAre(render::NotFinitePixels{"color", 5, {1, 1}}, render::NotFinitePixels{"depth", 1, {0, 0}}));
  EXPECT_EQ(sum.provenance.notFinitePixels, 6u);
}

}  // namespace
}  // namespace quintet::job
