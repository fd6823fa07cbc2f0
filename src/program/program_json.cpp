#include "program/program_json.h"

#include <nlohmann/json.hpp>

namespace quintet::program {
namespace {

using Json = nlohmann::ordered_json;

Json number(ParameterType type, double value) {
  if (type == ParameterType::boolean) return value != 0;
  if (isWhole(type)) return static_cast<std::int64_t>(value);
  return value;
}

Json defaultOf(const Parameter& parameter) {
  if (parameter.type == ParameterType::image || parameter.type == ParameterType::choice)
    return formatDefault(parameter);
  Json values = Json::array();
  for (std::size_t i = 0; i < static_cast<std::size_t>(componentCount(parameter.type)); ++i)
    values.push_back(number(parameter.type, parameter.defaultValue[i]));
  return values.size() == 1 ? values[0] : values;
}

Json describe(const Parameter& parameter) {
  Json json{{"name", parameter.name}, {"type", typeName(parameter.type)}, {"default", defaultOf(parameter)}};
  if (parameter.type == ParameterType::choice) {
    json["choices"] = parameter.choices;
  } else if (parameter.type == ParameterType::image) {
    json["encoding"] = parameter.sRgb ? "srgb" : "linear";
  } else {
    json["min"] = hasMin(parameter) ? number(parameter.type, parameter.min) : Json();
    json["max"] = hasMax(parameter) ? number(parameter.type, parameter.max) : Json();
  }
  json["unit"] = parameter.unit;
  json["help"] = parameter.help;
  return json;
}

}  // namespace

std::string describeAsJson(const Program& program) {
  Json rays = Json::array(), outputs = Json::array(), parameters = Json::array();
  for (const RayType& ray : program.rays) rays.push_back(ray.name);
  for (const Output& output : program.outputs)
    outputs.push_back({{"name", output.name},
                       {"kind", outputKindName(output.kind)},
                       {"pixel", outputPixelName(output.pixel)},
                       {"optional", output.optional},
                       {"channels", outputChannels(output)},
                       {"help", output.help}});
  for (const Parameter& parameter : program.parameters) parameters.push_back(describe(parameter));
  const Json json{{"name", program.name},
                  {"description", program.description},
                  {"accumulation", program.accumulation == Accumulation::program ? "program" : "film"},
                  {"rays", rays},
                  {"parameters", parameters},
                  {"outputs", outputs}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace quintet::program
