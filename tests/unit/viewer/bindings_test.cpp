// SPDX-License-Identifier: Apache-2.0
#include "viewer/bindings.h"

#include <set>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

namespace quintet::viewer {
namespace {

constexpr Modifiers kNone{};
constexpr Modifiers kShift{.shift = true};
constexpr Modifiers kControl{.control = true};
constexpr Modifiers kAlt{.alt = true};

TEST(Bindings, FollowTheExamineModeOfVkGltfRenderer) {
  const BindingSet& set = bindingSet("vk_gltf_renderer");
  EXPECT_EQ(dragOf(set, MouseButton::left, kNone), Drag::orbit);
  EXPECT_EQ(dragOf(set, MouseButton::left, kControl), Drag::pan);
  EXPECT_EQ(dragOf(set, MouseButton::left, kShift), Drag::zoom);
  EXPECT_EQ(dragOf(set, MouseButton::left, kAlt), Drag::look);
  EXPECT_EQ(dragOf(set, MouseButton::middle, kNone), Drag::pan);
  EXPECT_EQ(dragOf(set, MouseButton::right, kNone), Drag::zoom);
  EXPECT_EQ(dragOf(set, MouseButton::middle, kControl), std::nullopt);
}

TEST(Bindings, FollowTheViewportOfBlender) {
  const BindingSet& set = bindingSet("Blender");
  EXPECT_EQ(dragOf(set, MouseButton::middle, kNone), Drag::orbit);
  EXPECT_EQ(dragOf(set, MouseButton::middle, kShift), Drag::pan);
  EXPECT_EQ(dragOf(set, MouseButton::middle, kControl), Drag::zoom);
  EXPECT_EQ(dragOf(set, MouseButton::left, kNone), std::nullopt) << "the left button selects";
  EXPECT_EQ(actionOf(set, "A", kNone), Action::frameAll);
  EXPECT_EQ(actionOf(set, "Keypad .", kNone), Action::frameSelected);
}

TEST(Bindings, HaveTheSameCommonKeysInAllSets) {
  for (const BindingSet& set : bindingSets()) {
    EXPECT_EQ(actionOf(set, "F", kNone), Action::frameSelected) << set.name;
    EXPECT_EQ(actionOf(set, "Home", kNone), Action::frameAll) << set.name;
    EXPECT_EQ(actionOf(set, "Z", kControl), Action::undo) << set.name;
    EXPECT_EQ(actionOf(set, "Z", {.shift = true, .control = true}), Action::redo) << set.name;
    EXPECT_EQ(actionOf(set, "?", kNone), Action::help) << set.name;
    EXPECT_EQ(actionOf(set, "Z", kNone), std::nullopt) << set.name;
  }
}

// Each key does one thing: also the keys that move the camera.
TEST(Bindings, AreUnambiguous) {
  for (const BindingSet& set : bindingSets()) {
    std::set<std::tuple<std::string, bool, bool, bool>> keys;
    for (const KeyBinding& binding : set.keys) {
      const Modifiers& m = binding.modifiers;
      EXPECT_TRUE(keys.emplace(binding.key, m.shift, m.control, m.alt).second) << set.name << " " << binding.key;
    }
    if (!set.flyNeedsButton) {
      for (const FlyBinding& binding : set.flies)
        EXPECT_TRUE(keys.emplace(binding.key, false, false, false).second) << set.name << " " << binding.key;
    }
    std::set<std::tuple<MouseButton, bool, bool, bool>> drags;
    for (const DragBinding& binding : set.drags) {
      const Modifiers& m = binding.modifiers;
      EXPECT_TRUE(drags.emplace(binding.button, m.shift, m.control, m.alt).second) << set.name;
    }
  }
}

TEST(Bindings, ReachEveryActionAndDescribeIt) {
  for (const BindingSet& set : bindingSets())
    for (int i = 0; i <= static_cast<int>(Action::quit); ++i) {
      EXPECT_FALSE(keysOf(set, static_cast<Action>(i)).empty()) << set.name << " " << i;
      EXPECT_FALSE(description(static_cast<Action>(i)).empty()) << i;
    }
  for (int i = 0; i <= static_cast<int>(Drag::look); ++i) EXPECT_FALSE(description(static_cast<Drag>(i)).empty());
  for (int i = 0; i <= static_cast<int>(Fly::down); ++i) EXPECT_FALSE(description(static_cast<Fly>(i)).empty());
}

TEST(Bindings, RepeatOnlyActionsThatStep) {
  for (const Action action : {Action::undo, Action::redo, Action::lessExposure, Action::moreExposure})
    EXPECT_TRUE(repeats(action)) << description(action);
  for (const Action action : {Action::addBookmark, Action::playPause, Action::togglePanels, Action::toggleFullScreen,
                              Action::help, Action::compare})
    EXPECT_FALSE(repeats(action)) << description(action);
}

TEST(Bindings, AreShownAsText) {
  const BindingSet& set = bindingSets().front();
  EXPECT_EQ(keysOf(set, Action::redo), "Ctrl+Shift+Z or Ctrl+Y");
  EXPECT_EQ(dragText({MouseButton::middle, kShift, Drag::pan}), "Shift + middle button");
}

TEST(Bindings, DefaultToTheFirstSet) { EXPECT_EQ(&bindingSet("unknown"), &bindingSets().front()); }

}  // namespace
}  // namespace quintet::viewer
