// SPDX-License-Identifier: Apache-2.0
// The progress that front ends show.
#include "job/observer.h"

#include <gtest/gtest.h>

#include <limits>

namespace quintet::job {
namespace {

TEST(Progress, FollowsTheLimitThatIsReachedFirst) {
  Progress progress;
  progress.samples = 16;
  progress.seconds = 10;
  EXPECT_EQ(progress.fraction(), 0.0);
  EXPECT_EQ(progress.secondsLeft(), std::numeric_limits<double>::infinity());
  progress.sampleLimit = 64;
  EXPECT_DOUBLE_EQ(progress.fraction(), 0.25);
  EXPECT_DOUBLE_EQ(progress.secondsLeft(), 30.0);
  progress.secondLimit = 20;
  EXPECT_DOUBLE_EQ(progress.fraction(), 0.5);
  EXPECT_DOUBLE_EQ(progress.secondsLeft(), 10.0);
  progress.seconds = 30;
  EXPECT_DOUBLE_EQ(progress.fraction(), 1.0);
  EXPECT_DOUBLE_EQ(progress.secondsLeft(), 0.0);
}

// The error falls with the square root of the number of samples.
TEST(Progress, FollowsTheTargetError) {
  Progress progress;
  progress.samples = 16;
  progress.seconds = 10;
  progress.targetSamples = 64;
  EXPECT_DOUBLE_EQ(progress.fraction(), 0.25);
  EXPECT_DOUBLE_EQ(progress.secondsLeft(), 30.0);
  progress.sampleLimit = 32;  // earlier
  EXPECT_DOUBLE_EQ(progress.fraction(), 0.5);
  EXPECT_DOUBLE_EQ(progress.secondsLeft(), 10.0);
  progress.sampleLimit.reset();
  progress.samples = 80;  // more than expected
  EXPECT_DOUBLE_EQ(progress.fraction(), 1.0);
  EXPECT_DOUBLE_EQ(progress.secondsLeft(), 0.0);
}

}  // namespace
}  // namespace quintet::job
