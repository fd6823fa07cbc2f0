// SPDX-License-Identifier: Apache-2.0
// Input of the window, independent of the window system.
#ifndef QUINTET_APPS_VIEWER_WINDOW_INPUT_EVENT_H
#define QUINTET_APPS_VIEWER_WINDOW_INPUT_EVENT_H

#include <string>
#include <variant>
#include <vector>

#include "base/math.h"
#include "viewer/bindings.h"

namespace quintet::viewer {

// Positions are screen coordinates from the top left corner of the window, as those of Dear ImGui.
struct KeyEvent {
  std::string key;       // as in bindings.h
  std::string position;  // the letter on a US keyboard, for keys that are held; empty for other keys
  Modifiers modifiers;
  bool pressed = false;
  bool repeated = false;
};
struct ButtonEvent {
  MouseButton button = MouseButton::left;
  Modifiers modifiers;
  vec2 position{0.0f};
  bool pressed = false;
};
struct MoveEvent {
  vec2 position{0.0f};
};
struct WheelEvent {
  float steps = 0;
  vec2 position{0.0f};
};
struct DropEvent {
  std::vector<std::string> paths;
};
struct FocusEvent {
  bool focused = false;
};

using InputEvent = std::variant<KeyEvent, ButtonEvent, MoveEvent, WheelEvent, DropEvent, FocusEvent>;

}  // namespace quintet::viewer
#endif
