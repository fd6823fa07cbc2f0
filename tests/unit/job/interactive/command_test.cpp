// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/command.h"

#include <gtest/gtest.h>

namespace quintet::job::interactive {
namespace {

TEST(UndoGroup, IsTheKindAndTheTarget) {
  EXPECT_EQ(undoGroup(Orbit{1, 0}), undoGroup(Orbit{2, 3}));
  EXPECT_NE(undoGroup(Orbit{}), undoGroup(Pan{}));
  EXPECT_EQ(undoGroup(SetParameter{"a", "1"}), undoGroup(SetParameter{"a", "2"}));
  EXPECT_NE(undoGroup(SetParameter{"a", "1"}), undoGroup(SetParameter{"b", "1"}));
  EXPECT_NE(undoGroup(SetTransform{"i"}), undoGroup(Move{"i"}));
  EXPECT_NE(undoGroup(Move{"i"}), undoGroup(Move{"j"}));
  EXPECT_NE(undoGroup(SetLens{.verticalFov = 1.0f}), undoGroup(SetLens{.focusDistance = 1.0f}));
  EXPECT_NE(undoGroup(SetEnvironment{.on = true}), undoGroup(SetEnvironment{.rotation = 1.0f}));
}

TEST(UndoGroup, HasTheNamesOfProperties) {
  EXPECT_EQ(undoGroup(EditMaterial{"m", {{"roughness", {1}}}}), undoGroup(EditMaterial{"m", {{"roughness", {0}}}}));
  EXPECT_NE(undoGroup(EditMaterial{"m", {{"roughness", {1}}}}), undoGroup(EditMaterial{"n", {{"roughness", {1}}}}));
  EXPECT_NE(undoGroup(EditMaterial{"m", {{"roughness", {1}}}}), undoGroup(EditMaterial{"m", {{"metallic", {1}}}}));
  EXPECT_NE(undoGroup(EditMaterial{"m", {{"a", {1}}, {"b", {1}}}}), undoGroup(EditMaterial{"m:a", {{"b", {1}}}}));
  EXPECT_NE(undoGroup(EditMaterial{"m", {{"on", {1}}}}), undoGroup(EditLight{"m", {{"on", {1}}}}));
}

TEST(UndoName, SaysWhatChanges) {
  EXPECT_EQ(undoName(Move{"Lamp"}), "move of 'Lamp'");
  EXPECT_EQ(undoName(EditMaterial{"Gold", {{"roughness", {1}}}}), "roughness of 'Gold'");
  EXPECT_EQ(undoName(EditLight{"Sun", {{"color", {1, 1, 1}}, {"intensity", {2}}}}), "2 properties of 'Sun'");
  EXPECT_EQ(undoName(SetParameter{"bounces", "3"}), "parameter 'bounces'");
  EXPECT_EQ(undoName(SetLens{.apertureRadius = 1.0f}), "aperture");
  EXPECT_EQ(undoName(SetEnvironment{.rotation = 90.0f}), "rotation of the environment");
  EXPECT_EQ(undoName(Frame{}), "view of the scene");
  EXPECT_EQ(undoName(Undo{}), "") << "not a step";
}

TEST(UndoGroup, IsEmptyForStepsOfTheirOwn) {
  EXPECT_EQ(undoGroup(SetProgram{"ao"}), "");
  EXPECT_EQ(undoGroup(SelectOutput{"color"}), "");
  EXPECT_EQ(undoGroup(SetCamera{}), "");
}

}  // namespace
}  // namespace quintet::job::interactive
