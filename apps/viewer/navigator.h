// SPDX-License-Identifier: Apache-2.0
// Mouse and keys over the image: navigation, selection, and actions.
#ifndef QUINTET_APPS_VIEWER_NAVIGATOR_H
#define QUINTET_APPS_VIEWER_NAVIGATOR_H

#include <optional>
#include <set>
#include <vector>

#include "overlays/overlays.h"
#include "view_state.h"
#include "viewer/bindings.h"
#include "window/input_event.h"

namespace quintet::viewer {

class Navigator {
 public:
  // Handles the input of one frame. `area`: where the image can be. Returns the actions of keys. Dropped files stay in
  // the events.
  std::vector<Action> handle(ViewState& state, const std::vector<InputEvent>& events, const Area& area);
  // Moves the camera while keys are held.
  void fly(ViewState& state, double seconds);
  bool flying() const { return !held_.empty(); }

 private:
  // A pressed button: a drag, or a click until the pointer moves.
  struct Press {
    MouseButton button = MouseButton::left;
    std::optional<Drag> drag;
    vec2 start{0.0f}, last{0.0f};
    bool moved = false;
    bool control = false;  // Ctrl is held
  };

  void onButton(ViewState& state, const ButtonEvent& event, const Area& area);
  void onMove(ViewState& state, vec2 position);
  void onClick(ViewState& state, vec2 position, bool control);
  std::optional<Action> onKey(ViewState& state, const KeyEvent& event);

  std::optional<Press> press_;
  vec2 pointer_{0.0f};
  double lastClick_ = -1;  // ViewState::time
  vec2 lastClickAt_{0.0f};
  std::set<Fly> held_;
  bool fast_ = false;
};

}  // namespace quintet::viewer
#endif
