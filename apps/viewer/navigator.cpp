// SPDX-License-Identifier: Apache-2.0
#include "navigator.h"

#include <utility>
#include <variant>

#include "gui/gui.h"

namespace quintet::viewer {
namespace {

namespace interactive = job::interactive;

constexpr float kClickPixels = 4.0f;  // a longer movement is a drag
constexpr double kDoubleClickSeconds = 0.4;

bool contains(const Area& area, vec2 position) {
  const vec2 offset = position - area.origin;
  return offset.x >= 0 && offset.y >= 0 && offset.x < area.size.x && offset.y < area.size.y;
}

}  // namespace

std::vector<Action> Navigator::handle(ViewState& state, const std::vector<InputEvent>& events, const Area& area) {
  std::vector<Action> actions;
  for (const InputEvent& event : events) {
    if (const auto* button = std::get_if<ButtonEvent>(&event)) {
      onButton(state, *button, area);
    } else if (const auto* move = std::get_if<MoveEvent>(&event)) {
      onMove(state, move->position);
    } else if (const auto* wheel = std::get_if<WheelEvent>(&event)) {
      if (state.snapshot->navigation && contains(area, wheel->position) && !Gui::wantsMouse())
        state.apply(wheelCommand(wheel->steps, wheel->position, state.placement));
    } else if (const auto* key = std::get_if<KeyEvent>(&event)) {
      if (const std::optional<Action> action = onKey(state, *key)) actions.push_back(*action);
    } else if (const auto* focus = std::get_if<FocusEvent>(&event)) {
      if (!focus->focused) held_.clear();  // the release of the keys will not be reported
    }
  }
  const bool inside = contains(area, pointer_) && !Gui::wantsMouse();
  state.hoveredPixel = inside ? state.placement.pixelAt(pointer_) : std::nullopt;
  return actions;
}

void Navigator::onButton(ViewState& state, const ButtonEvent& event, const Area& area) {
  pointer_ = event.position;
  if (event.pressed) {
    if (press_ || !state.ready() || !contains(area, event.position) || Gui::wantsMouse()) return;
    const std::optional<Drag> drag = dragOf(bindingSet(state.settings.bindings), event.button, event.modifiers);
    press_ = Press{event.button,   state.snapshot->navigation ? drag : std::nullopt,
                   event.position, event.position,
                   false,          event.modifiers.control};
    return;
  }
  if (!press_ || press_->button != event.button) return;
  const Press press = *press_;
  press_.reset();
  if (press.drag == Drag::look && bindingSet(state.settings.bindings).flyNeedsButton) held_.clear();
  if (press.moved)
    state.apply(interactive::EndDrag{});
  else if (press.button == MouseButton::left)
    onClick(state, event.position, press.control);
}

void Navigator::onMove(ViewState& state, vec2 position) {
  pointer_ = position;
  if (!press_) return;
  if (!press_->moved && glm::length(position - press_->start) < kClickPixels * state.scale) return;
  press_->moved = true;
  if (press_->drag && state.ready())
    state.apply(dragCommand(*press_->drag, position - press_->last, press_->start, state.placement));
  press_->last = position;
}

void Navigator::onClick(ViewState& state, vec2 position, bool control) {
  const std::optional<uvec2> pixel = state.placement.pixelAt(position);
  const ClickUse use = std::exchange(state.click, ClickUse::select);
  if (control || use != ClickUse::select) {
    if (pixel && use == ClickUse::print)
      state.printPixels({pixel->x, pixel->y, 1, 1});
    else if (pixel)
      state.explainPixel(*pixel, state.explain.sample);
    return;
  }
  const bool twice = state.time - lastClick_ < kDoubleClickSeconds &&
                     glm::length(position - lastClickAt_) < kClickPixels * state.scale;
  lastClick_ = twice ? -1 : state.time;
  lastClickAt_ = position;
  if (!pixel || (!twice && selectRay(state, position))) return;
  state.session->pick(*pixel, twice ? PickUse::focus : PickUse::select);
}

std::optional<Action> Navigator::onKey(ViewState& state, const KeyEvent& event) {
  if (Gui::wantsKeyboard()) {
    held_.clear();
    return std::nullopt;
  }
  const BindingSet& set = bindingSet(state.settings.bindings);
  fast_ = event.modifiers.shift;
  const bool plain = !event.modifiers.control && !event.modifiers.alt;
  const bool looking = press_ && press_->drag == Drag::look;
  if (const std::optional<Fly> fly = flyOf(set, event.position)) {
    if (!event.pressed) {
      if (held_.erase(*fly) > 0 && held_.empty()) state.apply(interactive::EndDrag{});
      return std::nullopt;
    }
    if (plain && (looking || !set.flyNeedsButton)) {
      if (state.snapshot->navigation) held_.insert(*fly);
      return std::nullopt;
    }
  }
  if (!event.pressed || event.key.empty()) return std::nullopt;
  const std::optional<Action> action = actionOf(set, event.key, event.modifiers);
  return action && (!event.repeated || repeats(*action)) ? action : std::nullopt;
}

void Navigator::fly(ViewState& state, double seconds) {
  if (!state.ready() || !state.snapshot->navigation) return;
  if (const auto command = flyCommand(held_, seconds, state.snapshot->scene->size, fast_)) state.apply(*command);
}

}  // namespace quintet::viewer
