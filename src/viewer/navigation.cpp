// SPDX-License-Identifier: Apache-2.0
#include "viewer/navigation.h"

#include <algorithm>
#include <cmath>

namespace quintet::viewer {
namespace {

namespace interactive = job::interactive;

constexpr float kDegreesPerPixel = 0.3f;
constexpr float kLookDegreesPerPixel = 0.15f;
constexpr float kZoomPerPixel = 0.005f;  // logarithm of the factor
constexpr float kZoomPerStep = 1.15f;    // of the wheel
constexpr double kSecondsAcross = 4.0;
constexpr float kFast = 4.0f;

}  // namespace

interactive::Command dragCommand(Drag drag, vec2 moved, vec2 start, const overlay::ImagePlacement& placement) {
  switch (drag) {
    case Drag::orbit: return interactive::Orbit{-kDegreesPerPixel * moved.x, kDegreesPerPixel * moved.y};
    case Drag::pan: return interactive::Pan{moved / placement.scale};
    case Drag::zoom: return interactive::Zoom{std::exp(kZoomPerPixel * (moved.x - moved.y)), placement.toImage(start)};
    case Drag::look:
      return interactive::Fly{.yaw = -kLookDegreesPerPixel * moved.x, .pitch = -kLookDegreesPerPixel * moved.y};
  }
  return interactive::EndDrag{};
}

interactive::Command wheelCommand(float steps, vec2 position, const overlay::ImagePlacement& placement) {
  return interactive::Zoom{std::pow(kZoomPerStep, steps), placement.toImage(position)};
}

std::optional<interactive::Command> flyCommand(const std::set<Fly>& held, double seconds, float sceneSize, bool fast) {
  const auto axis = [&](Fly positive, Fly negative) {
    return static_cast<float>(held.count(positive)) - static_cast<float>(held.count(negative));
  };
  const vec3 direction{axis(Fly::right, Fly::left), axis(Fly::up, Fly::down), axis(Fly::forward, Fly::backward)};
  if (direction == vec3(0.0f) || !(seconds > 0.0)) return std::nullopt;
  const auto distance = static_cast<float>(seconds / kSecondsAcross) * sceneSize * (fast ? kFast : 1.0f);
  return interactive::Fly{.meters = distance * glm::normalize(direction)};
}

}  // namespace quintet::viewer
