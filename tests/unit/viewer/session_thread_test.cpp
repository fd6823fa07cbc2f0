// SPDX-License-Identifier: Apache-2.0
// Which commands replace each other in the queue. tests/gpu/viewer runs the thread.
#include "viewer/session_thread.h"

#include <gtest/gtest.h>

#include "viewer/rate_history.h"

namespace quintet::viewer {
namespace {

using namespace job::interactive;

TEST(CommandQueue, KeepsOnlyTheLatestValue) {
  EXPECT_TRUE(overwrites(SetExposure{1}, SetExposure{2}));
  EXPECT_TRUE(overwrites(SetSize{{1, 1}}, SetSize{{2, 2}}));
  EXPECT_TRUE(overwrites(SetFrame{1}, SetFrame{2}));
  EXPECT_TRUE(overwrites(SetParameter{"a", "1"}, SetParameter{"a", "2"}));
  EXPECT_TRUE(overwrites(EditMaterial{"m", {{"roughness", {1}}}}, EditMaterial{"m", {{"roughness", {0}}}}));
  EXPECT_TRUE(overwrites(EditLight{"l", {{"on", {1}}}}, EditLight{"l", {{"on", {0}}}}));
  EXPECT_TRUE(overwrites(SetTransform{"i", mat4(1)}, SetTransform{"i", mat4(2)}));
  EXPECT_TRUE(overwrites(SetLens{.verticalFov = 1.0f}, SetLens{.verticalFov = 2.0f}));
  EXPECT_TRUE(overwrites(SetEnvironment{.rotation = 1.0f}, SetEnvironment{.rotation = 2.0f}));
  EXPECT_TRUE(overwrites(SetSamples{1}, SetSamples{2}));
  EXPECT_TRUE(overwrites(SetToneMap{}, SetToneMap{render::ToneMap::linear}));
}

TEST(CommandQueue, KeepsCommandsThatAddUp) {
  EXPECT_FALSE(overwrites(Orbit{1, 0}, Orbit{1, 0}));
  EXPECT_FALSE(overwrites(Pan{{1, 0}}, Pan{{1, 0}}));
  EXPECT_FALSE(overwrites(Zoom{2}, Zoom{2}));
  EXPECT_FALSE(overwrites(job::interactive::Fly{{1, 0, 0}}, job::interactive::Fly{{1, 0, 0}}));
  EXPECT_FALSE(overwrites(Move{"i", {1, 0, 0}}, Move{"i", {1, 0, 0}}));
  EXPECT_FALSE(overwrites(Undo{}, Undo{}));
  EXPECT_FALSE(overwrites(EndDrag{}, EndDrag{}));
}

TEST(CommandQueue, KeepsCommandsForOtherTargets) {
  EXPECT_FALSE(overwrites(SetExposure{1}, SetFrame{1}));
  EXPECT_FALSE(overwrites(SetParameter{"a", "1"}, SetParameter{"b", "1"}));
  EXPECT_FALSE(overwrites(EditMaterial{"m", {{"roughness", {1}}}}, EditMaterial{"n", {{"roughness", {1}}}}));
  EXPECT_FALSE(overwrites(EditMaterial{"m", {{"roughness", {1}}}}, EditMaterial{"m", {{"metallic", {1}}}}));
  EXPECT_FALSE(overwrites(SetTransform{"i", mat4(1)}, SetTransform{"j", mat4(1)}));
  EXPECT_FALSE(overwrites(SetLens{.verticalFov = 1.0f}, SetLens{.focusDistance = 2.0f}));
  EXPECT_FALSE(overwrites(SetEnvironment{.on = true}, SetEnvironment{.rotation = 2.0f}));
}

TEST(RateHistory, KeepsTheLatestValues) {
  RateHistory history;
  EXPECT_TRUE(history.empty());
  EXPECT_EQ(history.latest(), 0.0f);
  for (std::size_t i = 0; i < RateHistory::kLength + 3; ++i) history.add(static_cast<float>(i));
  ASSERT_EQ(history.values().size(), RateHistory::kLength);
  EXPECT_EQ(history.values().front(), 3.0f);
  EXPECT_EQ(history.latest(), static_cast<float>(RateHistory::kLength + 2));
  EXPECT_EQ(history.largest(), history.latest());
}

}  // namespace
}  // namespace quintet::viewer
