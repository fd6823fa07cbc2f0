// SPDX-License-Identifier: Apache-2.0
#include "lab/session_events.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "check/diagnostic_text.h"
#include "program/help.h"
#include "render/tone_map/tone_map.h"
#include "shader/include_resolver.h"

namespace quintet::lab {
namespace {

using OrderedJson = nlohmann::ordered_json;
using job::interactive::Session;

std::string lineOf(const OrderedJson& json) { return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace); }

// JSON has no such numbers.
OrderedJson numberJson(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}

// The double with the fewest digits that rounds to this float.
OrderedJson shortest(float value) {
  if (!std::isfinite(value)) return numberJson(value);
  return std::stod(fmt::format("{}", value));
}

OrderedJson pointJson(const vec3& point) {
  return OrderedJson::array({shortest(point.x), shortest(point.y), shortest(point.z)});
}

OrderedJson listJson(const std::vector<std::string>& names) {
  OrderedJson list = OrderedJson::array();
  for (const std::string& name : names)
    if (list.size() < kMaxListedNames) list.push_back(name);
  return list;
}

OrderedJson cameraJson(const Session& session) {
  if (session.camera().orthographic) return nullptr;
  const job::interactive::OrbitCamera camera = session.navigation();
  const vec3 up = camera.worldFromCamera * vec3(0, 1, 0);
  OrderedJson json{{"from", pointJson(camera.eye())},
                   {"at", pointJson(camera.center)},
                   {"up", pointJson(up)},
                   {"fov", shortest(glm::degrees(camera.verticalFov))}};
  if (camera.apertureRadius > 0) {
    json["aperture"] = shortest(camera.apertureRadius);
    json["focus"] = shortest(camera.focusDistance);
  }
  return json;
}

}  // namespace

bool usesCamera(const program::Program& program) {
  return std::ranges::any_of(program.files, [](const auto& file) {
    return std::ranges::any_of(shader::findIncludes(file.second), [](const shader::IncludeDirective& include) {
      return include.name == "quintet/camera.glsl";
    });
  });
}

std::string openedJson(const Session& session, const std::string& program, const std::string& scene,
                       const std::string& device) {
  OrderedJson cameras = OrderedJson::array();
  for (const scene::Camera& camera : session.scene().cameras)
    if (cameras.size() < kMaxListedNames) cameras.push_back(camera.name);
  return lineOf({{"event", "opened"},
                 {"program", program},
                 {"scene", scene},
                 {"device", device},
                 {"description", OrderedJson::parse(program::describeAsJson(session.program()))},
                 {"materials", listJson(session.materialNames())},
                 {"lights", listJson(session.lightNames())},
                 {"instances", listJson(session.instanceNames())},
                 {"cameras", std::move(cameras)},
                 {"usesCamera", usesCamera(session.program())},
                 {"animated", session.isAnimated()},
                 {"lastFrame", session.lastFrame()}});
}

std::string stateJson(const Session& session, const std::string& program, bool paused, bool still) {
  const job::interactive::SessionState& state = session.state();
  return lineOf(
      {{"event", "state"},
       {"program", program},
       {"parameters", OrderedJson::parse(session.parameters().toJson())},
       {"output", state.output},
       {"exposure", state.exposure},
       {"tonemap", state.toneMap ? render::toneMapNames().at(static_cast<std::size_t>(*state.toneMap)) : "default"},
       {"width", state.size.x},
       {"height", state.size.y},
       {"samples", state.samples},
       {"frame", shortest(state.frame)},
       {"frames", session.program().accumulation == program::Accumulation::program},
       {"still", still},
       {"paused", paused},
       {"camera", cameraJson(session)},
       {"environment",
        {{"source", state.environment.source},
         {"intensity", shortest(state.environment.intensity.value_or(1))},
         {"rotation", shortest(state.environment.rotation.value_or(0))},
         {"on", state.environmentOn}}},
       {"canUndo", session.canUndo()},
       {"canRedo", session.canRedo()},
       {"prints", session.callsPrint()}});
}

std::string diagnosticsJson(const std::vector<Diagnostic>& diagnostics, bool outdated) {
  return lineOf({{"event", "diagnostics"},
                 {"diagnostics", OrderedJson::parse(check::diagnosticsJson(diagnostics))},
                 {"outdated", outdated}});
}

std::string statisticsJson(const Statistics& statistics) {
  return lineOf({{"event", "statistics"},
                 {"samples", statistics.samples},
                 {"frames", statistics.frames},
                 {"seconds", statistics.seconds},
                 {"raysPerSecond", statistics.raysPerSecond},
                 {"error", statistics.error ? numberJson(*statistics.error) : OrderedJson(nullptr)}});
}

std::string imageJson(const job::interactive::ImageUpdated& image, std::uint32_t number) {
  return lineOf({{"event", "image"},
                 {"number", number},
                 {"samples", image.samples},
                 {"width", image.size.x},
                 {"height", image.size.y},
                 {"factor", image.factor},
                 {"complete", image.complete}});
}

std::string valueJson(uvec2 pixel, const std::vector<float>& value) {
  OrderedJson numbers = OrderedJson::array();
  for (const float number : value) numbers.push_back(shortest(number));
  return lineOf({{"event", "value"}, {"x", pixel.x}, {"y", pixel.y}, {"value", std::move(numbers)}});
}

std::string fileJson(std::uint32_t number, const std::string& name, const std::string& type, std::uint64_t bytes) {
  return lineOf({{"event", "file"}, {"file", number}, {"name", name}, {"type", type}, {"size", bytes}});
}

std::string progressJson(std::uint64_t done, std::uint64_t total) {
  return lineOf({{"event", "progress"}, {"done", done}, {"total", total}});
}

std::string graphJson(const std::string& graph) {
  return lineOf({{"event", "graph"}, {"graph", OrderedJson::parse(graph)}});
}

std::string workerJson(const std::string& state, const std::string& message, unsigned restarts) {
  return lineOf({{"event", "worker"}, {"state", state}, {"message", message}, {"restarts", restarts}});
}

std::string openingJson(std::uint32_t number) { return lineOf({{"event", "opening"}, {"number", number}}); }

std::string messageJson(const std::string& event, const std::string& message, const std::string& key) {
  return lineOf({{"event", event}, {key, message}});
}

std::string withId(const std::string& event, const std::string& id) {
  return id.empty() ? event : event.substr(0, event.size() - 1) + ",\"id\":" + id + "}";
}

}  // namespace quintet::lab
