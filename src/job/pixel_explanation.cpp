// SPDX-License-Identifier: Apache-2.0
#include "job/pixel_explanation.h"

#include <algorithm>

#include <fmt/format.h>

namespace quintet::job {

std::string originText(const ValueOrigin& origin) {
  return fmt::format("the result of this {} is {}", origin.operation, origin.isNan ? "NaN" : "infinite");
}

const EventValue* ExplainedEvent::find(std::string_view name) const {
  const auto found = std::ranges::find(fields, name, [](const auto& field) { return std::string_view(field.first); });
  return found == fields.end() ? nullptr : &found->second;
}

std::string ExplainedEvent::text(std::string_view name) const {
  const EventValue* value = find(name);
  const auto* result = value ? std::get_if<std::string>(value) : nullptr;
  return result ? *result : std::string();
}

float ExplainedEvent::number(std::string_view name) const {
  const EventValue* value = find(name);
  const auto* result = value ? std::get_if<float>(value) : nullptr;
  return result ? *result : 0.0f;
}

std::int64_t ExplainedEvent::integer(std::string_view name) const {
  const EventValue* value = find(name);
  const auto* result = value ? std::get_if<std::int64_t>(value) : nullptr;
  return result ? *result : 0;
}

bool ExplainedEvent::flag(std::string_view name) const {
  const EventValue* value = find(name);
  const auto* result = value ? std::get_if<bool>(value) : nullptr;
  return result && *result;
}

vec3 ExplainedEvent::vector(std::string_view name) const {
  vec3 result(0.0f);
  const EventValue* value = find(name);
  const auto* numbers = value ? std::get_if<std::vector<float>>(value) : nullptr;
  for (std::size_t i = 0; numbers && i < std::min<std::size_t>(3, numbers->size()); ++i) result[i] = (*numbers)[i];
  return result;
}

void ExplainedEvent::set(std::string name, EventValue value) {
  const auto found = std::ranges::find(fields, name, &std::pair<std::string, EventValue>::first);
  if (found == fields.end())
    fields.emplace_back(std::move(name), std::move(value));
  else
    found->second = std::move(value);
}

std::vector<Contribution> contributionsOf(const PixelExplanation& explanation) {
  std::vector<Contribution> stated, stores;
  const std::string first = explanation.outputs.empty() ? std::string() : explanation.outputs.front().name;
  std::size_t rays = 0;
  forEachEvent(explanation.events, [&](const ExplainedEvent& event, int) {
    if (event.type == "ray") {
      ++rays;
    } else if (event.type == "contribution") {
      stated.push_back({event.vector("value"), event.text("source"), event.integer("scatterings"), rays});
    } else if (event.type == "store" && event.text("output") == first && !event.find("pixel")) {
      if (event.text("mode") == "store") stores.clear();  // it replaces all earlier values
      stores.push_back({event.vector("value"), "store", -1, 0});
    }
  });
  return stated.empty() ? stores : stated;
}

vec3 sumContributions(const PixelExplanation& explanation) {
  vec3 sum(0.0f);
  for (const Contribution& contribution : contributionsOf(explanation)) sum += contribution.value;
  return sum;
}

}  // namespace quintet::job
