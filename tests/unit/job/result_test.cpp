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

TEST(ResultWarnings, CountDiscardedSamples) {
  RenderResult result;
  result.provenance.droppedSamples = 1;
  EXPECT_THAT(resultWarnings(result), ElementsAre(HasSubstr("1 sample was")));
  result.provenance.droppedSamples = 3;
  EXPECT_THAT(resultWarnings(result), ElementsAre(HasSubstr("3 samples were")));
}

}  // namespace
}  // namespace quintet::job
