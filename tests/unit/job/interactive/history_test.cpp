// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/history.h"

#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace quintet::job::interactive {
namespace {

// A value with its history.
struct Edited {
  int value = 0;
  History<int> history;

  void set(int next, const std::string& group = "") { history.add(std::exchange(value, next), group); }
  void undo() {
    const int target = history.undone();
    history.undo(std::exchange(value, target));
  }
  void redo() {
    const int target = history.redone();
    history.redo(std::exchange(value, target));
  }
};

TEST(SessionHistory, UndoesAndRedoes) {
  Edited edited;
  EXPECT_FALSE(edited.history.canUndo());
  edited.set(1);
  edited.set(2);
  edited.undo();
  EXPECT_EQ(edited.value, 1);
  edited.undo();
  EXPECT_EQ(edited.value, 0);
  EXPECT_FALSE(edited.history.canUndo());
  edited.redo();
  edited.redo();
  EXPECT_EQ(edited.value, 2);
  EXPECT_FALSE(edited.history.canRedo());
}

TEST(SessionHistory, ANewStepEndsRedo) {
  Edited edited;
  edited.set(1);
  edited.undo();
  edited.set(5);
  EXPECT_FALSE(edited.history.canRedo());
  edited.undo();
  EXPECT_EQ(edited.value, 0);
}

TEST(SessionHistory, DropsAStep) {
  Edited edited;
  edited.set(1);
  edited.set(2, "orbit");
  edited.history.dropUndo();
  EXPECT_EQ(edited.history.undone(), 0);
  edited.set(3, "orbit");
  edited.undo();
  EXPECT_EQ(edited.value, 2) << "the next step is a new one";
  edited.history.dropRedo();
  EXPECT_FALSE(edited.history.canRedo());
}

TEST(SessionHistory, KeepsTheNamesOfSteps) {
  History<int> history;
  EXPECT_EQ(history.undoName(), "");
  history.add(0, "", "exposure");
  history.add(1, "orbit", "turn of the camera");
  history.add(2, "orbit", "a part of the same step");
  EXPECT_EQ(history.undoName(), "turn of the camera");
  EXPECT_EQ(history.redoName(), "");
  history.undo(3);
  EXPECT_EQ(history.undoName(), "exposure");
  EXPECT_EQ(history.redoName(), "turn of the camera");
  history.redo(1);
  EXPECT_EQ(history.undoName(), "turn of the camera");
}

TEST(SessionHistory, AGroupIsOneStep) {
  Edited edited;
  edited.set(1, "orbit");
  edited.set(2, "orbit");
  edited.set(3, "pan");
  edited.set(4, "pan");
  edited.history.endGroup();
  edited.set(5, "pan");
  edited.undo();
  EXPECT_EQ(edited.value, 4);
  edited.undo();
  EXPECT_EQ(edited.value, 2) << "another kind of step";
  edited.set(9, "orbit");
  edited.undo();
  EXPECT_EQ(edited.value, 2) << "undo ends the group";
  edited.undo();
  EXPECT_EQ(edited.value, 0);
}

}  // namespace
}  // namespace quintet::job::interactive
