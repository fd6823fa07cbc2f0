// SPDX-License-Identifier: Apache-2.0
#include "viewer/bindings.h"

#include <algorithm>

namespace quintet::viewer {
namespace {

constexpr Modifiers kNone{};
constexpr Modifiers kShift{.shift = true};
constexpr Modifiers kControl{.control = true};
constexpr Modifiers kControlShift{.shift = true, .control = true};
constexpr Modifiers kAlt{.alt = true};

// Keys that all sets share.
std::vector<KeyBinding> commonKeys() {
  return {
      {"F", kNone, Action::frameSelected},
      {"Home", kNone, Action::frameAll},
      {"R", kNone, Action::resetCamera},
      {"Z", kControl, Action::undo},
      {"Z", kControlShift, Action::redo},
      {"Y", kControl, Action::redo},
      {"O", kControl, Action::open},
      {"S", kControl, Action::save},
      {"C", kControl, Action::copyCommand},
      {"B", kNone, Action::addBookmark},
      {"Space", kNone, Action::playPause},
      {"PageUp", kNone, Action::previousOutput},
      {"PageDown", kNone, Action::nextOutput},
      {"-", kNone, Action::lessExposure},
      {"+", kNone, Action::moreExposure},
      {"=", kNone, Action::moreExposure},
      {"X", kNone, Action::compare},
      {"X", kShift, Action::openReference},
      {"I", kNone, Action::explain},
      {"P", kNone, Action::print},
      {"E", kControl, Action::saveExplanation},
      {"I", kControl, Action::copyExplainCommand},
      {"V", kNone, Action::toggleRays},
      {"Tab", kNone, Action::togglePanels},
      {"N", kNone, Action::togglePanels},
      {"0", kNone, Action::fitImage},
      {"F11", kNone, Action::toggleFullScreen},
      {"L", kNone, Action::toggleTheme},
      {"?", kNone, Action::help},
      {"F1", kNone, Action::help},
      {"Escape", kNone, Action::close},
      {"Q", kControl, Action::quit},
  };
}

std::vector<FlyBinding> flyKeys() {
  return {{"W", Fly::forward}, {"S", Fly::backward}, {"A", Fly::left},
          {"D", Fly::right},   {"E", Fly::up},       {"Q", Fly::down}};
}

// The examine mode of NVIDIA's vk_gltf_renderer. Keys move the camera at any time.
BindingSet gltfRenderer() {
  BindingSet set;
  set.name = "vk_gltf_renderer";
  set.drags = {{MouseButton::left, kNone, Drag::orbit}, {MouseButton::left, kControl, Drag::pan},
               {MouseButton::left, kShift, Drag::zoom}, {MouseButton::left, kAlt, Drag::look},
               {MouseButton::middle, kNone, Drag::pan}, {MouseButton::right, kNone, Drag::zoom},
               {MouseButton::right, kShift, Drag::look}};
  set.keys = commonKeys();
  set.flies = flyKeys();
  return set;
}

// Blender's viewport, with its emulation of the middle button (Alt and the left button). 'A' is free because keys move
// the camera only while it looks around.
BindingSet blender() {
  BindingSet set;
  set.name = "Blender";
  set.drags = {{MouseButton::middle, kNone, Drag::orbit},
               {MouseButton::middle, kShift, Drag::pan},
               {MouseButton::middle, kControl, Drag::zoom},
               {MouseButton::left, kAlt, Drag::orbit},
               {MouseButton::right, kNone, Drag::look}};
  set.keys = commonKeys();
  set.keys.push_back({"A", kNone, Action::frameAll});
  set.keys.push_back({"Keypad .", kNone, Action::frameSelected});
  set.flies = flyKeys();
  set.flyNeedsButton = true;
  return set;
}

std::string_view buttonName(MouseButton button) {
  switch (button) {
    case MouseButton::left: return "left button";
    case MouseButton::middle: return "middle button";
    case MouseButton::right: return "right button";
  }
  return "";
}

std::string modifierText(const Modifiers& modifiers, std::string_view separator) {
  std::string text;
  if (modifiers.control) text.append("Ctrl").append(separator);
  if (modifiers.shift) text.append("Shift").append(separator);
  if (modifiers.alt) text.append("Alt").append(separator);
  return text;
}

}  // namespace

std::span<const BindingSet> bindingSets() {
  static const std::vector<BindingSet> kSets{gltfRenderer(), blender()};
  return kSets;
}

const BindingSet& bindingSet(std::string_view name) {
  const auto sets = bindingSets();
  const auto found = std::ranges::find(sets, name, &BindingSet::name);
  return found == sets.end() ? sets.front() : *found;
}

std::optional<Drag> dragOf(const BindingSet& set, MouseButton button, const Modifiers& modifiers) {
  for (const DragBinding& binding : set.drags)
    if (binding.button == button && binding.modifiers == modifiers) return binding.drag;
  return std::nullopt;
}

std::optional<Action> actionOf(const BindingSet& set, std::string_view key, const Modifiers& modifiers) {
  for (const KeyBinding& binding : set.keys)
    if (binding.key == key && binding.modifiers == modifiers) return binding.action;
  return std::nullopt;
}

bool repeats(Action action) {
  return action == Action::undo || action == Action::redo || action == Action::lessExposure ||
         action == Action::moreExposure;
}

std::optional<Fly> flyOf(const BindingSet& set, std::string_view key) {
  for (const FlyBinding& binding : set.flies)
    if (binding.key == key) return binding.fly;
  return std::nullopt;
}

std::string_view description(Drag drag) {
  switch (drag) {
    case Drag::orbit: return "Turn around the orbit center";
    case Drag::pan: return "Move the camera sideways";
    case Drag::zoom: return "Move closer or away";
    case Drag::look: return "Look around";
  }
  return "";
}

std::string_view description(Action action) {
  switch (action) {
    case Action::frameSelected: return "Show the selected object";
    case Action::frameAll: return "Show the whole scene";
    case Action::resetCamera: return "Go back to the initial view";
    case Action::undo: return "Undo";
    case Action::redo: return "Redo";
    case Action::open: return "Open a file";
    case Action::save: return "Save the image";
    case Action::copyCommand: return "Copy the command that renders this image";
    case Action::addBookmark: return "Add a bookmark of the camera";
    case Action::playPause: return "Play or pause the animation";
    case Action::previousOutput: return "Show the previous output";
    case Action::nextOutput: return "Show the next output";
    case Action::lessExposure: return "Reduce the exposure by a third of a stop";
    case Action::moreExposure: return "Increase the exposure by a third of a stop";
    case Action::openReference: return "Choose an image to compare with";
    case Action::compare: return "Compare with the reference image";
    case Action::explain: return "Explain the pixel at the pointer";
    case Action::print: return "Show what the program prints for the pixel at the pointer";
    case Action::saveExplanation: return "Save the explanation as JSON";
    case Action::copyExplainCommand: return "Copy the command that explains this pixel";
    case Action::toggleRays: return "Show or hide the rays of the explained pixel";
    case Action::togglePanels: return "Show or hide the panels";
    case Action::fitImage: return "Render at the size of the window";
    case Action::toggleFullScreen: return "Use the full screen";
    case Action::toggleTheme: return "Switch between the dark and the light theme";
    case Action::help: return "Show this help";
    case Action::close: return "Close a dialog, hide the explanation, or clear the selection";
    case Action::quit: return "Quit";
  }
  return "";
}

std::string_view description(Fly fly) {
  switch (fly) {
    case Fly::forward: return "Move forward";
    case Fly::backward: return "Move backward";
    case Fly::left: return "Move left";
    case Fly::right: return "Move right";
    case Fly::up: return "Move up";
    case Fly::down: return "Move down";
  }
  return "";
}

std::string keyText(const KeyBinding& binding) { return modifierText(binding.modifiers, "+").append(binding.key); }

std::string dragText(const DragBinding& binding) {
  return modifierText(binding.modifiers, " + ").append(buttonName(binding.button));
}

std::string keysOf(const BindingSet& set, Action action) {
  std::string text;
  for (const KeyBinding& binding : set.keys)
    if (binding.action == action) text.append(text.empty() ? "" : " or ").append(keyText(binding));
  return text;
}

}  // namespace quintet::viewer
