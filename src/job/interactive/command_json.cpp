// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/command_json.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/suggestion.h"

namespace quintet::job::interactive {
namespace {

Command parseZoom(JsonFields& fields) {
  Zoom zoom{fields.real("factor", 1), {}};
  const std::optional<double> x = fields.findNumber("x"), y = fields.findNumber("y");
  if (x.has_value() != y.has_value()) throw UsageError("'x' and 'y' require each other");
  if (x) zoom.pixel = vec2(*x, *y);
  return zoom;
}

Command parseLook(JsonFields& fields) {
  CameraRequest camera;
  camera.lookFrom = fields.findPoint("from");
  if (!camera.lookFrom) throw UsageError("'from' is missing");
  camera.lookAt = fields.findPoint("at");
  camera.up = fields.findPoint("up").value_or(camera.up);
  return SetCamera{camera};
}

std::optional<float> findReal(JsonFields& fields, const char* name) {
  const std::optional<double> value = fields.findNumber(name);
  return value ? std::optional(static_cast<float>(*value)) : std::nullopt;
}

Command parseLens(JsonFields& fields) {
  SetLens lens;
  lens.verticalFov = findReal(fields, "fov");
  lens.apertureRadius = findReal(fields, "aperture");
  lens.focusDistance = findReal(fields, "focus");
  if (!lens.verticalFov && !lens.apertureRadius && !lens.focusDistance) {
    fields.rejectOthers();  // a misspelled name explains more
    throw UsageError("no value of the lens is given");
  }
  return lens;
}

// All members but the name of the object.
std::vector<Property> parseProperties(JsonFields& fields, const char* kind) {
  std::vector<Property> properties;
  for (auto& [name, numbers] : fields.otherNumbers()) properties.push_back({name, numbers});
  if (properties.empty()) throw UsageError(fmt::format("no property of the {} is given", kind));
  return properties;
}

Command parseMaterial(JsonFields& fields) {
  EditMaterial edit{fields.text("name"), {}};
  edit.properties = parseProperties(fields, "material");
  return edit;
}

Command parseLight(JsonFields& fields) {
  EditLight edit{fields.text("name"), {}};
  edit.properties = parseProperties(fields, "light");
  return edit;
}

Command parseEnvironment(JsonFields& fields) {
  SetEnvironment environment;
  environment.source = fields.findText("source");
  environment.intensity = findReal(fields, "intensity");
  environment.rotation = findReal(fields, "rotation");
  environment.on = fields.findFlag("on");
  if (!environment.source && !environment.intensity && !environment.rotation && !environment.on) {
    fields.rejectOthers();
    throw UsageError("no value of the environment is given");
  }
  return environment;
}

Command parseOrbitCenter(JsonFields& fields) {
  const std::vector<double> point = fields.numbers("point", 3);
  return SetOrbitCenter{vec3(point[0], point[1], point[2])};
}

Command parseTransform(JsonFields& fields) {
  SetTransform transform;
  transform.instance = fields.text("instance");
  const std::vector<double> values = fields.numbers("matrix", 12);
  for (glm::length_t row = 0; row < 3; ++row)
    for (glm::length_t column = 0; column < 4; ++column)
      transform.worldFromObject[column][row] = static_cast<float>(values[static_cast<std::size_t>(4 * row + column)]);
  return transform;
}

Command parseMove(JsonFields& fields) {
  const std::string instance = fields.text("instance");
  const std::vector<double> by = fields.numbers("by", 3);
  return Move{instance, vec3(by[0], by[1], by[2])};
}

Command parseToneMap(JsonFields& fields) {
  const std::string name = fields.text("name");
  if (name == "default") return SetToneMap{};
  const std::optional<render::ToneMap> toneMap = render::toneMapByName(name);
  if (!toneMap)
    throw UsageError(fmt::format("unknown tone map '{}'{}", name, suggestionOrList(name, render::toneMapNames())));
  return SetToneMap{toneMap};
}

Command parsePrint(JsonFields& fields) {
  if (!fields.findFlag("on").value_or(true)) return SetPrint{};
  PrintRequest print;
  print.all = fields.findFlag("all").value_or(false);
  if (fields.has("limit")) print.limit = fields.count("limit");
  if (!print.all) {
    print.pixels.x = fields.index("x");
    print.pixels.y = fields.index("y");
    print.pixels.width = fields.has("width") ? fields.count("width") : 1;
    print.pixels.height = fields.has("height") ? fields.count("height") : 1;
  }
  return SetPrint{print};
}

using Parser = Command (*)(JsonFields&);
constexpr std::pair<std::string_view, Parser> kParsers[] = {
    {"orbit",
     [](JsonFields& f) -> Command {
       return Orbit{f.real("dx", 0), f.real("dy", 0)};
     }},
    {"pan",
     [](JsonFields& f) -> Command {
       return Pan{{f.real("dx", 0), f.real("dy", 0)}};
     }},
    {"zoom", parseZoom},
    {"fly",
     [](JsonFields& f) -> Command {
       const vec3 meters(f.real("right", 0), f.real("up", 0), f.real("forward", 0));
       return Fly{meters, f.real("yaw", 0), f.real("pitch", 0)};
     }},
    {"endDrag", [](JsonFields&) -> Command { return EndDrag{}; }},
    {"frame", [](JsonFields& f) -> Command { return Frame{f.findText("instance").value_or("")}; }},
    {"camera", [](JsonFields& f) -> Command { return SetCamera{{.name = f.text("name")}}; }},
    {"look", parseLook},
    {"lens", parseLens},
    {"orbitCenter", parseOrbitCenter},
    {"program", [](JsonFields& f) -> Command { return SetProgram{f.text("name")}; }},
    {"set",
     [](JsonFields& f) -> Command {
       const std::string name = f.text("parameter");
       return SetParameter{name, f.assignedValue("value")};
     }},
    {"material", parseMaterial},
    {"light", parseLight},
    {"environment", parseEnvironment},
    {"transform", parseTransform},
    {"move", parseMove},
    {"time", [](JsonFields& f) -> Command { return SetFrame{static_cast<float>(f.number("frame"))}; }},
    {"output", [](JsonFields& f) -> Command { return SelectOutput{f.text("name")}; }},
    {"exposure", [](JsonFields& f) -> Command { return SetExposure{f.number("stops")}; }},
    {"tonemap", parseToneMap},
    {"size",
     [](JsonFields& f) -> Command {
       const std::uint32_t width = f.count("width");
       return SetSize{{width, f.count("height")}};
     }},
    {"samples", [](JsonFields& f) -> Command { return SetSamples{f.count("count")}; }},
    {"print", parsePrint},
    {"rewind", [](JsonFields&) -> Command { return Rewind{}; }},
    {"undo", [](JsonFields&) -> Command { return Undo{}; }},
    {"redo", [](JsonFields&) -> Command { return Redo{}; }},
};

}  // namespace

std::vector<std::string> commandNames() {
  std::vector<std::string> names;
  for (const auto& [name, parser] : kParsers) names.emplace_back(name);
  return names;
}

Command parseCommand(const std::string& name, JsonFields& fields, const std::vector<std::string>& moreNames) {
  const auto found = std::ranges::find(kParsers, name, &std::pair<std::string_view, Parser>::first);
  if (found == std::end(kParsers)) {
    std::vector<std::string> names = commandNames();
    names.insert(names.end(), moreNames.begin(), moreNames.end());
    throw UsageError(fmt::format("unknown command '{}'{}", name, suggestionOrList(name, names)));
  }
  const Command command = found->second(fields);
  fields.rejectOthers();
  return command;
}

}  // namespace quintet::job::interactive
