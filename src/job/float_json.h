// SPDX-License-Identifier: Apache-2.0
// Floats as JSON, which has no numbers for NaN and infinity: the texts "nan", "inf" and "-inf".
#ifndef QUINTET_JOB_FLOAT_JSON_H
#define QUINTET_JOB_FLOAT_JSON_H

#include <optional>
#include <span>

#include <nlohmann/json.hpp>

namespace quintet::job {

// Returns a number with the shortest text that gives the same float, or one of the texts.
nlohmann::ordered_json floatJson(float value);
nlohmann::ordered_json floatsJson(std::span<const float> values);

// Returns what floatJson() wrote; unset for other values.
std::optional<float> floatFromJson(const nlohmann::ordered_json& json);

}  // namespace quintet::job
#endif
