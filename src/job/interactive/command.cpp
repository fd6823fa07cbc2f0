// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/command.h"

#include <fmt/format.h>

namespace quintet::job::interactive {
namespace {

// Line breaks separate names, because names of a scene can have any other character.
struct GroupOf {
  static std::string ofProperties(const char* kind, const std::string& name, const std::vector<Property>& properties) {
    std::string group = fmt::format("{}\n{}", kind, name);
    for (const Property& property : properties) group += "\n" + property.name;
    return group;
  }

  std::string operator()(const Orbit&) const { return "orbit"; }
  std::string operator()(const Pan&) const { return "pan"; }
  std::string operator()(const Zoom&) const { return "zoom"; }
  std::string operator()(const Fly&) const { return "fly"; }
  std::string operator()(const SetLens& c) const {
    return fmt::format("lens {} {} {}", c.verticalFov.has_value(), c.apertureRadius.has_value(),
                       c.focusDistance.has_value());
  }
  std::string operator()(const SetParameter& c) const { return "parameter\n" + c.name; }
  std::string operator()(const EditMaterial& c) const { return ofProperties("material", c.material, c.properties); }
  std::string operator()(const EditLight& c) const { return ofProperties("light", c.light, c.properties); }
  std::string operator()(const SetEnvironment& c) const {
    return fmt::format("environment {} {} {} {}", c.source.has_value(), c.intensity.has_value(), c.rotation.has_value(),
                       c.on.has_value());
  }
  std::string operator()(const SetTransform& c) const { return "transform\n" + c.instance; }
  std::string operator()(const Move& c) const { return "move\n" + c.instance; }
  std::string operator()(const SetFrame&) const { return "frame"; }
  std::string operator()(const SetExposure&) const { return "exposure"; }
  std::string operator()(const SetSize&) const { return "size"; }
  template <class T>
  std::string operator()(const T&) const {
    return {};
  }
};

struct NameOf {
  static std::string ofProperties(const std::string& name, const std::vector<Property>& properties) {
    if (properties.size() == 1) return fmt::format("{} of '{}'", properties.front().name, name);
    return fmt::format("{} properties of '{}'", properties.size(), name);
  }

  std::string operator()(const Orbit&) const { return "turn of the camera"; }
  std::string operator()(const Pan&) const { return "pan of the camera"; }
  std::string operator()(const Zoom&) const { return "zoom"; }
  std::string operator()(const Fly&) const { return "flight of the camera"; }
  std::string operator()(const Frame& c) const {
    return c.instance.empty() ? "view of the scene" : fmt::format("view of '{}'", c.instance);
  }
  std::string operator()(const SetOrbitCenter&) const { return "orbit center"; }
  std::string operator()(const SetCamera& c) const {
    return c.camera.name.empty() ? "camera" : fmt::format("camera '{}'", c.camera.name);
  }
  std::string operator()(const SetLens& c) const {
    const int count = c.verticalFov.has_value() + c.apertureRadius.has_value() + c.focusDistance.has_value();
    if (count != 1) return "lens";
    return c.verticalFov ? "field of view" : c.apertureRadius ? "aperture" : "focus distance";
  }
  std::string operator()(const SetProgram& c) const { return fmt::format("program '{}'", c.name); }
  std::string operator()(const SetParameter& c) const { return fmt::format("parameter '{}'", c.name); }
  std::string operator()(const EditMaterial& c) const { return ofProperties(c.material, c.properties); }
  std::string operator()(const EditLight& c) const { return ofProperties(c.light, c.properties); }
  std::string operator()(const SetEnvironment& c) const {
    if (c.source) return "environment";
    if (c.intensity && !c.rotation && !c.on) return "intensity of the environment";
    if (c.rotation && !c.intensity && !c.on) return "rotation of the environment";
    return "environment";
  }
  std::string operator()(const SetTransform& c) const { return fmt::format("move of '{}'", c.instance); }
  std::string operator()(const Move& c) const { return fmt::format("move of '{}'", c.instance); }
  std::string operator()(const SetFrame&) const { return "frame of the animation"; }
  std::string operator()(const SelectOutput& c) const { return fmt::format("output '{}'", c.name); }
  std::string operator()(const SetExposure&) const { return "exposure"; }
  std::string operator()(const SetToneMap&) const { return "tone mapping"; }
  std::string operator()(const SetSize&) const { return "size of the image"; }
  std::string operator()(const SetSamples&) const { return "number of samples"; }
  template <class T>
  std::string operator()(const T&) const {
    return {};
  }
};

}  // namespace

std::string undoName(const Command& command) { return std::visit(NameOf{}, command); }

std::string undoGroup(const Command& command) { return std::visit(GroupOf{}, command); }

}  // namespace quintet::job::interactive
