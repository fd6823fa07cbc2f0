// SPDX-License-Identifier: Apache-2.0
#include "job/float_json.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include <fmt/format.h>

namespace quintet::job {

nlohmann::ordered_json floatJson(float value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0.0f ? "inf" : "-inf";
  return std::strtod(fmt::format("{}", value).c_str(), nullptr);  // the double with this text
}

nlohmann::ordered_json floatsJson(std::span<const float> values) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const float value : values) json.push_back(floatJson(value));
  return json;
}

std::optional<float> floatFromJson(const nlohmann::ordered_json& json) {
  if (json.is_number()) return json.get<float>();
  if (json == "nan") return std::numeric_limits<float>::quiet_NaN();
  if (json == "inf") return std::numeric_limits<float>::infinity();
  if (json == "-inf") return -std::numeric_limits<float>::infinity();
  return std::nullopt;
}

}  // namespace quintet::job
