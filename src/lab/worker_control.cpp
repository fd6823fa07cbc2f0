// SPDX-License-Identifier: Apache-2.0
#include "lab/worker_control.h"

#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/json.h"

namespace quintet::lab {
namespace {

using Json = nlohmann::json;

std::string controlText(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

template <class Function>
auto parsed(const Function& function) {
  try {
    return function();
  } catch (const Json::exception&) {
    throw Error("the server of the lab and a worker do not understand each other");
  }
}

}  // namespace

std::string settingsJson(const WorkerSettings& settings) {
  const LabDefaults& defaults = settings.defaults;
  return controlText({{"folder", settings.folder},
                      {"files", settings.files},
                      {"device", settings.device},
                      {"contained", settings.contained},
                      {"memory", settings.memory},
                      {"process", settings.process},
                      {"width", defaults.size.x},
                      {"height", defaults.size.y},
                      {"samples", defaults.samples},
                      {"timeout", defaults.timeout}});
}

WorkerSettings parseSettings(std::string_view json) {
  return parsed([&] {
    const Json object = parseJson(json);
    WorkerSettings settings;
    settings.folder = object.at("folder").get<std::string>();
    settings.files = object.at("files").get<std::vector<std::string>>();
    settings.device = object.at("device").get<std::string>();
    settings.contained = object.at("contained").get<bool>();
    settings.memory = object.at("memory").get<std::uint64_t>();
    settings.process = object.at("process").get<std::int64_t>();
    settings.defaults.size = uvec2(object.at("width").get<std::uint32_t>(), object.at("height").get<std::uint32_t>());
    settings.defaults.samples = object.at("samples").get<std::uint32_t>();
    settings.defaults.timeout = object.at("timeout").get<double>();
    return settings;
  });
}

std::string controlJson(const ControlMessage& message) {
  return controlText({{"control", static_cast<int>(message.control)}, {"message", message.message}});
}

ControlMessage parseControl(std::string_view json) {
  return parsed([&] {
    const Json object = parseJson(json);
    return ControlMessage{static_cast<Control>(object.at("control").get<int>()),
                          object.at("message").get<std::string>()};
  });
}

}  // namespace quintet::lab
