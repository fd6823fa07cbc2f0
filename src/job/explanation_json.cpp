// SPDX-License-Identifier: Apache-2.0
#include "job/explanation_json.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "base/json.h"
#include "job/float_json.h"

namespace quintet::job {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "quintet-explanation";
constexpr int kFormatVersion = 1;
constexpr std::size_t kMaxDepth = 256;  // of nested events

// Fields that are always texts, also if the text is that of a number: the user can name an instance "nan". `hitKind`
// can be a text or an integer, and its texts are fixed.
constexpr std::string_view kTexts[] = {"stage",  "file",     "rayType",     "records",   "flags", "missShader",
                                       "result", "callable", "variable",    "dataType",  "when",  "output",
                                       "mode",   "side",     "light",       "lightType", "lobe",  "source",
                                       "reason", "material", "instanceName"};

struct ToJson {
  Json operator()(bool value) const { return value; }
  Json operator()(std::int64_t value) const { return value; }
  Json operator()(float value) const { return floatJson(value); }
  Json operator()(const std::string& value) const { return value; }
  Json operator()(const std::vector<float>& values) const { return floatsJson(values); }
  Json operator()(const std::vector<std::int64_t>& values) const { return values; }
};

Json eventJson(const ExplainedEvent& event) {
  Json json{{"type", event.type}};
  for (const auto& [name, value] : event.fields) json[name] = std::visit(ToJson(), value);
  if (event.children.empty()) return json;
  Json& children = json["events"] = Json::array();
  for (const ExplainedEvent& child : event.children) children.push_back(eventJson(child));
  return json;
}

// Reads values and names their location in errors.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file) {}

  PixelExplanation read(const Json& json) const {
    if (!json.is_object() || json.value("format", Json()) != kFormat)
      throw FileError(file_, "not an explanation, which quintet explain-pixel writes as JSON");
    if (json.value("formatVersion", Json()) != kFormatVersion)
      throw FileError(file_, "/formatVersion",
                      fmt::format("not supported; this Quintet reads version {}", kFormatVersion));
    PixelExplanation result;
    result.version = text(json, "", "version");
    result.scene = text(json, "", "scene");
    result.program = text(json, "", "program");
    result.parameters = text(json, "", "parameters");
    result.camera = text(json, "", "camera");
    result.device = text(json, "", "device");
    result.driver = text(json, "", "driver");
    result.size = pair(json, "size");
    result.pixel = pair(json, "pixel");
    result.frames = json.contains("frame");
    result.sample = static_cast<std::uint32_t>(integer(json, "", result.frames ? "frame" : "sample"));
    result.plannedSamples = static_cast<std::uint64_t>(integer(json, "", "plannedSamples"));
    result.seed = static_cast<std::uint64_t>(integer(json, "", "seed"));
    result.discarded = member(json, "", "discarded").get<bool>();
    if (json.contains("origin")) {
      const Json& origin = json["origin"];
      result.origin =
          ValueOrigin{{text(origin, "/origin", "file"), static_cast<int>(integer(origin, "/origin", "line")), 0},
                      text(origin, "/origin", "stage"),
                      text(origin, "/origin", "operation"),
                      member(origin, "/origin", "nan").get<bool>()};
    }
    result.lostRecords = static_cast<std::uint32_t>(integer(json, "", "lostRecords"));
    const Json& outputs = array(json, "", "outputs");
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const std::string at = fmt::format("/outputs/{}", i);
      result.outputs.push_back(
          {text(outputs[i], at, "name"), color(outputs[i], at, "value"), color(outputs[i], at, "recorded")});
    }
    result.events = events(json, "", 0);
    return result;
  }

  [[noreturn]] void fail(const std::string& at, const std::string& problem) const {
    throw FileError(file_, at.empty() ? "/" : at, problem);
  }

 private:
  const Json& member(const Json& json, const std::string& at, const char* name) const {
    if (!json.is_object() || !json.contains(name)) fail(at, fmt::format("'{}' is missing", name));
    return json[name];
  }
  std::string text(const Json& json, const std::string& at, const char* name) const {
    const Json& value = member(json, at, name);
    if (!value.is_string()) fail(at + "/" + name, "must be a text");
    return value.get<std::string>();
  }
  std::int64_t integer(const Json& json, const std::string& at, const char* name) const {
    const Json& value = member(json, at, name);
    if (!value.is_number_integer()) fail(at + "/" + name, "must be an integer");
    return value.get<std::int64_t>();
  }
  const Json& array(const Json& json, const std::string& at, const char* name) const {
    const Json& value = member(json, at, name);
    if (!value.is_array()) fail(at + "/" + name, "must be an array");
    return value;
  }
  uvec2 pair(const Json& json, const char* name) const {
    const Json& value = array(json, "", name);
    if (value.size() != 2 || !value[0].is_number_unsigned() || !value[1].is_number_unsigned())
      fail(std::string("/") + name, "must be two integers of at least 0");
    return {value[0].get<std::uint32_t>(), value[1].get<std::uint32_t>()};
  }
  vec4 color(const Json& json, const std::string& at, const char* name) const {
    const Json& value = array(json, at, name);
    vec4 result(0.0f);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::optional<float> number = i < value.size() ? floatFromJson(value[i]) : std::nullopt;
      if (!number || value.size() != 4) fail(at + "/" + name, "must be four numbers");
      result[i] = *number;
    }
    return result;
  }

  EventValue value(const std::string& name, const Json& json, const std::string& event) const {
    const std::string at = event + "/" + name;
    if (std::ranges::find(kTexts, name) != std::end(kTexts)) {
      if (!json.is_string()) fail(at, "must be a text");
      return json.get<std::string>();
    }
    if (json.is_boolean()) return json.get<bool>();
    if (json.is_number_integer()) return json.get<std::int64_t>();
    if (const std::optional<float> number = floatFromJson(json)) return *number;
    if (json.is_string()) return json.get<std::string>();
    if (!json.is_array()) fail(at, "must be a text, a number, a boolean or an array of numbers");
    std::vector<float> floats;
    std::vector<std::int64_t> integers;
    for (const Json& element : json) {
      const std::optional<float> number = floatFromJson(element);
      if (!number) fail(at, "must be an array of numbers");
      floats.push_back(*number);
      if (element.is_number_integer()) integers.push_back(element.get<std::int64_t>());
    }
    return integers.size() == floats.size() ? EventValue(std::move(integers)) : EventValue(std::move(floats));
  }

  std::vector<ExplainedEvent> events(const Json& json, const std::string& at, std::size_t depth) const {
    if (depth > kMaxDepth) fail(at, "events are nested too deeply");
    const Json& array = this->array(json, at, "events");
    std::vector<ExplainedEvent> result;
    for (std::size_t i = 0; i < array.size(); ++i) {
      const std::string here = fmt::format("{}/events/{}", at, i);
      ExplainedEvent event{text(array[i], here, "type"), {}, {}};
      for (const auto& [name, field] : array[i].items())
        if (name != "type" && name != "events") event.fields.emplace_back(name, value(name, field, here));
      if (array[i].contains("events")) event.children = events(array[i], here, depth + 1);
      result.push_back(std::move(event));
    }
    return result;
  }

  const std::filesystem::path& file_;
};

}  // namespace

std::string explanationJson(const PixelExplanation& e, const std::string& command) {
  Json json{{"format", kFormat},
            {"formatVersion", kFormatVersion},
            {"version", e.version},
            {"scene", e.scene},
            {"program", e.program},
            {"parameters", e.parameters},
            {"camera", e.camera},
            {"device", e.device},
            {"driver", e.driver},
            {"size", {e.size.x, e.size.y}},
            {"pixel", {e.pixel.x, e.pixel.y}},
            {e.frames ? "frame" : "sample", e.sample},
            {"plannedSamples", e.plannedSamples},
            {"seed", e.seed}};
  if (!command.empty()) json["command"] = command;
  json["discarded"] = e.discarded;
  if (e.origin)
    json["origin"] = {{"file", e.origin->location.file},
                      {"line", e.origin->location.line},
                      {"stage", e.origin->stage},
                      {"operation", e.origin->operation},
                      {"nan", e.origin->isNan}};
  json["lostRecords"] = e.lostRecords;
  json["outputs"] = Json::array();
  for (const ExplainedOutput& output : e.outputs)
    json["outputs"].push_back({{"name", output.name},
                               {"value", floatsJson({&output.value[0], 4})},
                               {"recorded", floatsJson({&output.recorded[0], 4})}});
  Json& contributions = json["contributions"] = Json::array();
  for (const Contribution& contribution : contributionsOf(e)) {
    Json& entry = contributions.emplace_back();
    entry["source"] = contribution.source;
    entry["value"] = floatsJson({&contribution.value[0], 3});
    if (contribution.scatterings >= 0) entry["scatterings"] = contribution.scatterings;
    entry["ray"] = contribution.ray;
  }
  const vec3 sum = sumContributions(e);
  json["contributionSum"] = floatsJson({&sum[0], 3});
  json["events"] = Json::array();
  for (const ExplainedEvent& event : e.events) json["events"].push_back(eventJson(event));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

PixelExplanation readExplanation(const std::filesystem::path& file) {
  return parseExplanation(readTextFile(file), file);
}

PixelExplanation parseExplanation(const std::string& text, const std::filesystem::path& file) {
  Json json;
  try {
    json = parseJson<Json>(file, text);
  } catch (const Json::parse_error& error) {
    throw FileError(file, fmt::format("byte {}", error.byte), "not valid JSON");
  }
  try {
    return Reader(file).read(json);
  } catch (const Json::exception& error) {
    throw FileError(file, error.what());
  }
}

}  // namespace quintet::job
