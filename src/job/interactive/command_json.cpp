// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/command_json.h"

#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/embedded.h"
#include "base/error.h"

namespace quintet {

std::span<const EmbeddedFile> embeddedSessionProtocol();

namespace job::interactive {
namespace {

using Message = nlohmann::json;

vec3 toPoint(const Message& list) { return {list[0].get<float>(), list[1].get<float>(), list[2].get<float>()}; }

template <class T>
std::optional<T> findAt(const Message& message, const char* name) {
  const auto found = message.find(name);
  return found == message.end() ? std::nullopt : std::optional(found->get<T>());
}

std::string textAt(const Message& message, const char* name) { return message.at(name).get<std::string>(); }
float realAt(const Message& message, const char* name) { return message.at(name).get<float>(); }

uvec2 sizeOf(const Message& message) {
  return {message.at("width").get<std::uint32_t>(), message.at("height").get<std::uint32_t>()};
}

Command parseZoom(const Message& message) {
  Zoom zoom{realAt(message, "factor"), {}};
  if (message.contains("x")) zoom.pixel = vec2(realAt(message, "x"), realAt(message, "y"));
  return zoom;
}

double toNumber(const Message& value) { return value.is_boolean() ? value.get<bool>() : value.get<double>(); }

// All members but those of every command.
std::vector<Property> parseProperties(const Message& message) {
  std::vector<Property> properties;
  for (const auto& [name, value] : message.items()) {
    if (name == "do" || name == "name") continue;
    Property& property = properties.emplace_back(Property{name, {}});
    for (const Message& number : value.is_array() ? value : Message::array({value}))
      property.numbers.push_back(toNumber(number));
  }
  return properties;
}

Command parseTransform(const Message& message) {
  SetTransform transform{textAt(message, "instance")};
  const Message& values = message.at("matrix");
  for (glm::length_t row = 0; row < 3; ++row)
    for (glm::length_t column = 0; column < 4; ++column)
      transform.worldFromObject[column][row] = values[static_cast<std::size_t>(4 * row + column)].get<float>();
  return transform;
}

Command parsePrint(const Message& message) {
  if (!message.at("on").get<bool>()) return SetPrint{};
  PrintRequest print;
  print.all = message.at("all").get<bool>();
  print.limit = message.at("limit").get<std::uint64_t>();
  if (!print.all) {
    const uvec2 pixel = parsePixel(message), block = sizeOf(message);
    print.pixels = {pixel.x, pixel.y, block.x, block.y};
  }
  return SetPrint{print};
}

using Parser = Command (*)(const Message&);
const std::unordered_map<std::string, Parser> kParsers{
    {"orbit",
     [](const Message& m) -> Command {
       return Orbit{realAt(m, "dx"), realAt(m, "dy")};
     }},
    {"pan",
     [](const Message& m) -> Command {
       return Pan{{realAt(m, "dx"), realAt(m, "dy")}};
     }},
    {"zoom", parseZoom},
    {"fly",
     [](const Message& m) -> Command {
       return Fly{{realAt(m, "right"), realAt(m, "up"), realAt(m, "forward")}, realAt(m, "yaw"), realAt(m, "pitch")};
     }},
    {"endDrag", [](const Message&) -> Command { return EndDrag{}; }},
    {"frame", [](const Message& m) -> Command { return Frame{textAt(m, "instance")}; }},
    {"camera", [](const Message& m) -> Command { return SetCamera{{.name = textAt(m, "name")}}; }},
    {"look", [](const Message& m) -> Command { return SetCamera{parseCamera(m)}; }},
    {"lens",
     [](const Message& m) -> Command {
       return SetLens{findAt<float>(m, "fov"), findAt<float>(m, "aperture"), findAt<float>(m, "focus")};
     }},
    {"orbitCenter", [](const Message& m) -> Command { return SetOrbitCenter{toPoint(m.at("point"))}; }},
    {"program", [](const Message& m) -> Command { return SetProgram{textAt(m, "name")}; }},
    {"set",
     [](const Message& m) -> Command {
       return SetParameter{textAt(m, "parameter"), assignedValue(m.at("value"))};
     }},
    {"material",
     [](const Message& m) -> Command {
       return EditMaterial{textAt(m, "name"), parseProperties(m)};
     }},
    {"light",
     [](const Message& m) -> Command {
       return EditLight{textAt(m, "name"), parseProperties(m)};
     }},
    {"environment",
     [](const Message& m) -> Command {
       return SetEnvironment{findAt<std::string>(m, "source"), findAt<float>(m, "intensity"),
                             findAt<float>(m, "rotation"), findAt<bool>(m, "on")};
     }},
    {"transform", parseTransform},
    {"move",
     [](const Message& m) -> Command {
       return Move{textAt(m, "instance"), toPoint(m.at("by"))};
     }},
    {"time", [](const Message& m) -> Command { return SetFrame{realAt(m, "frame")}; }},
    {"output", [](const Message& m) -> Command { return SelectOutput{textAt(m, "name")}; }},
    {"exposure", [](const Message& m) -> Command { return SetExposure{m.at("stops").get<double>()}; }},
    {"tonemap", [](const Message& m) -> Command { return SetToneMap{render::toneMapByName(textAt(m, "name"))}; }},
    {"size", [](const Message& m) -> Command { return SetSize{sizeOf(m)}; }},
    {"samples", [](const Message& m) -> Command { return SetSamples{m.at("count").get<std::uint32_t>()}; }},
    {"print", parsePrint},
    {"rewind", [](const Message&) -> Command { return Rewind{}; }},
    {"undo", [](const Message&) -> Command { return Undo{}; }},
    {"redo", [](const Message&) -> Command { return Redo{}; }},
};

std::string_view protocolFile(std::string_view name) {
  for (const EmbeddedFile& file : embeddedSessionProtocol())
    if (file.path == name) return file.data;
  throw Error(fmt::format("{} is not embedded", name));
}

}  // namespace

std::string_view sessionProtocol() { return protocolFile("session_protocol.json"); }

const MessageSchema& sessionSchema() {
  static const MessageSchema kSchema({sessionProtocol()});
  return kSchema;
}

const MessageSchema& scriptSchema() {
  static const MessageSchema kSchema({sessionProtocol(), protocolFile("script_protocol.json")});
  return kSchema;
}

Command parseCommand(const Message& message) { return kParsers.at(textAt(message, "do"))(message); }

CameraRequest parseCamera(const Message& message) {
  CameraRequest camera{.lookFrom = toPoint(message.at("from")), .up = toPoint(message.at("up"))};
  if (message.contains("at")) camera.lookAt = toPoint(message["at"]);
  camera.verticalFov = findAt<float>(message, "fov");
  camera.apertureRadius = findAt<float>(message, "aperture");
  camera.focusDistance = findAt<float>(message, "focus");
  return camera;
}

uvec2 parsePixel(const Message& message) {
  for (const char* name : {"x", "y"})
    if (!message.contains(name)) throw UsageError(fmt::format("'{}' is missing", name));
  return {message["x"].get<std::uint32_t>(), message["y"].get<std::uint32_t>()};
}

std::string assignedValue(const Message& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_array()) return value.dump();
  std::string list;
  for (const Message& element : value) list += (list.empty() ? "" : ",") + element.dump();
  return list;
}

}  // namespace job::interactive
}  // namespace quintet
