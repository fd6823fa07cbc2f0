// SPDX-License-Identifier: Apache-2.0
// What keys and mouse buttons do, as tables: the same tables make the page of keyboard help.
#ifndef QUINTET_VIEWER_BINDINGS_H
#define QUINTET_VIEWER_BINDINGS_H

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quintet::viewer {

enum class MouseButton { left, middle, right };

struct Modifiers {
  bool shift = false, control = false, alt = false;
  bool operator==(const Modifiers&) const = default;
};

// Effect of moving the mouse while a button is pressed.
enum class Drag { orbit, pan, zoom, look };

// Effect of pressing a key.
enum class Action {
  frameSelected,
  frameAll,
  resetCamera,
  undo,
  redo,
  open,
  save,
  copyCommand,
  addBookmark,
  playPause,
  previousOutput,
  nextOutput,
  lessExposure,
  moreExposure,
  compare,
  openReference,
  explain,
  print,
  saveExplanation,
  copyExplainCommand,
  toggleRays,
  togglePanels,
  fitImage,
  toggleFullScreen,
  toggleTheme,
  help,
  close,
  quit,
};

// Effect of holding a key: movement of the camera.
enum class Fly { forward, backward, left, right, up, down };

// Letters and keys without a character have names: "A", "F11", "Home", "Space". Other keys are named by the character
// that they type, "?" or "+", so that they do not depend on the layout of the keyboard. Then Shift is no modifier.
struct DragBinding {
  MouseButton button = MouseButton::left;
  Modifiers modifiers;
  Drag drag = Drag::orbit;
};
struct KeyBinding {
  std::string_view key;
  Modifiers modifiers;
  Action action = Action::help;
};
struct FlyBinding {
  std::string_view key;
  Fly fly = Fly::forward;
};

// Pressing the left button with Ctrl, without moving the mouse, is Action::explain in all sets.
struct BindingSet {
  std::string_view name;
  std::vector<DragBinding> drags;
  std::vector<KeyBinding> keys;
  std::vector<FlyBinding> flies;  // without Ctrl and Alt; Shift moves faster
  bool flyNeedsButton = false;    // only while the button of a Drag::look is pressed
};

// All sets; the first is the default.
std::span<const BindingSet> bindingSets();
// The set of this name, else the default.
const BindingSet& bindingSet(std::string_view name);

std::optional<Drag> dragOf(const BindingSet& set, MouseButton button, const Modifiers& modifiers);
std::optional<Action> actionOf(const BindingSet& set, std::string_view key, const Modifiers& modifiers);
// Holding the key performs the action again and again.
bool repeats(Action action);
std::optional<Fly> flyOf(const BindingSet& set, std::string_view key);

std::string_view description(Drag drag);      // "Turn around the orbit center"
std::string_view description(Action action);  // "Show the selected object"
std::string_view description(Fly fly);        // "Move forward"

std::string keyText(const KeyBinding& binding);    // "Ctrl+Shift+Z"
std::string dragText(const DragBinding& binding);  // "Shift + middle button"
// The keys of an action, joined by " or "; empty if it has none.
std::string keysOf(const BindingSet& set, Action action);

}  // namespace quintet::viewer
#endif
