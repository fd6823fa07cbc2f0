// SPDX-License-Identifier: Apache-2.0
#include "job/interactive/event_json.h"

#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "check/diagnostic_text.h"
#include "job/explanation_json.h"
#include "job/printed_line_json.h"

namespace quintet::job::interactive {
namespace {

using Json = nlohmann::ordered_json;

struct ToJson {
  Json operator()(const Restarted&) const { return {{"event", "restarted"}}; }
  Json operator()(const ImageUpdated& e) const {
    return {{"event", "image"},   {"samples", e.samples}, {"width", e.size.x},
            {"height", e.size.y}, {"factor", e.factor},   {"complete", e.complete}};  // times differ between runs
  }
  Json operator()(const ProgramReloaded& e) const { return {{"event", "reloaded"}, {"files", e.files}}; }
  Json operator()(const DiagnosticsFound& e) const {
    return {{"event", "diagnostics"}, {"diagnostics", Json::parse(check::diagnosticsJson(e.diagnostics))}};
  }
  Json operator()(const LinesPrinted& e) const {
    Json lines = Json::array();
    for (const PrintedLine& line : e.printed.lines) lines.push_back(printedLineJson(line));
    return {{"event", "printed"}, {"lines", std::move(lines)}, {"omitted", e.printed.omitted}};
  }
  Json operator()(const DeviceReplaced& e) const {
    return {{"event", "deviceReplaced"}, {"device", e.device}, {"message", e.message}};
  }
  Json operator()(const Note& e) const { return {{"event", "note"}, {"message", e.text}}; }
  Json operator()(const Warning& e) const { return {{"event", "warning"}, {"message", e.text}}; }
  Json operator()(const Failed& e) const { return {{"event", "error"}, {"message", e.message}}; }
};

// The double with the fewest digits that rounds to this float.
double shortest(float value) { return std::stod(fmt::format("{}", value)); }

std::string lineOf(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

std::string eventJson(const Event& event) { return lineOf(std::visit(ToJson{}, event)); }

std::string savedJson(const std::string& file) { return lineOf({{"event", "saved"}, {"file", file}}); }

std::string pickedJson(uvec2 pixel, const std::optional<Pick>& pick, const std::vector<std::string>& instanceNames,
                       const std::vector<std::string>& materialNames) {
  Json json{{"event", "picked"}, {"x", pixel.x}, {"y", pixel.y}};
  if (!pick) {
    json["instance"] = nullptr;
    return lineOf(json);
  }
  const auto list = [](const vec3& v) { return Json{shortest(v.x), shortest(v.y), shortest(v.z)}; };
  json["instance"] = instanceNames.at(pick->instance);
  json["geometry"] = pick->geometry;
  json["primitive"] = pick->primitive;
  json["material"] = materialNames.at(pick->material);
  json["position"] = list(pick->position);
  json["normal"] = list(pick->normal);
  json["geometricNormal"] = list(pick->geometricNormal);
  json["front"] = pick->front;
  json["distance"] = shortest(pick->distance);
  return lineOf(json);
}

std::string explainedJson(const PixelExplanation& explanation, const std::string& file) {
  Json json{{"event", "explained"}, {"x", explanation.pixel.x}, {"y", explanation.pixel.y}};
  json[explanation.frames ? "frame" : "sample"] = explanation.sample;
  if (file.empty())
    json["explanation"] = Json::parse(explanationJson(explanation));
  else
    json["file"] = file;
  return lineOf(json);
}

std::string failedJson(std::uint64_t line, const std::string& message) {
  return lineOf({{"event", "error"}, {"line", line}, {"message", message}});
}

}  // namespace quintet::job::interactive
