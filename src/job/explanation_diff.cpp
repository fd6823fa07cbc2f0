// SPDX-License-Identifier: Apache-2.0
#include "job/explanation_diff.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

namespace quintet::job {
namespace {

constexpr const char* kMissing = "missing";

std::string floatText(float value) { return std::isnan(value) ? "nan" : fmt::format("{:.6g}", value); }

struct ToText {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return std::to_string(value); }
  std::string operator()(float value) const { return floatText(value); }
  std::string operator()(const std::string& value) const { return value.empty() ? "\"\"" : value; }
  std::string operator()(const std::vector<float>& values) const {
    std::string text;
    for (const float value : values) text += (text.empty() ? "" : ", ") + floatText(value);
    return "(" + text + ")";
  }
  std::string operator()(const std::vector<std::int64_t>& values) const {
    std::string text;
    for (const std::int64_t value : values) text += (text.empty() ? "" : ", ") + std::to_string(value);
    return "(" + text + ")";
  }
};

// The components of a number or a vector; empty for other values.
std::vector<float> components(const EventValue& value) {
  if (const auto* number = std::get_if<float>(&value)) return {*number};
  if (const auto* numbers = std::get_if<std::vector<float>>(&value)) return *numbers;
  return {};
}

// The largest difference of components; 0 for equal ones, also if they are not finite.
float distance(const std::vector<float>& a, const std::vector<float>& b) {
  float largest = 0.0f;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i]))) continue;
    const float difference = std::abs(a[i] - b[i]);
    largest = std::isnan(difference) ? std::numeric_limits<float>::infinity() : std::max(largest, difference);
  }
  return largest;
}

float size(const std::vector<float>& values) {
  float largest = 0.0f;
  for (const float value : values)
    if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
  return largest;
}

// The difference of two values; unset if they are equal. `error` is the distance of numbers.
std::optional<ExplanationDifference> compare(std::string location, const EventValue& a, const EventValue& b,
                                             const DiffTolerance& tolerance) {
  if (a == b) return {};
  ExplanationDifference difference{std::move(location), valueText(a), valueText(b), {}};
  const std::vector<float> x = components(a), y = components(b);
  if (x.empty() || x.size() != y.size()) return difference;
  difference.error = distance(x, y);
  if (*difference.error <= tolerance.absolute + tolerance.relative * std::max(size(x), size(y))) return {};
  return difference;
}

bool isLocation(const std::string& field) { return field == "line" || field == "file"; }

// The values before the call, for the data after it; null for other events.
struct Before {
  const ExplainedEvent* a;
  const ExplainedEvent* b;
};

const ExplainedEvent* findBefore(const std::vector<ExplainedEvent>& events, const ExplainedEvent& after) {
  if (after.text("when") != "after") return nullptr;
  for (const ExplainedEvent& event : events)
    if (event.type == after.type && event.text("when") == "before") return &event;
  return nullptr;
}

// What a program does not write is undefined. So the data before a call are not compared, nor what it left unchanged.
bool isUndefined(const ExplainedEvent& a, const ExplainedEvent& b, const Before& before, const std::string& name) {
  if (name == "when" || name == "variable" || name == "dataType") return false;
  if (a.text("when") == "before") return true;
  if (!before.a || !before.b) return false;
  const auto unchanged = [&](const ExplainedEvent& event, const ExplainedEvent& earlier) {
    const EventValue* value = event.find(name);
    const EventValue* old = earlier.find(name);
    return value && old && *value == *old;
  };
  return unchanged(a, *before.a) && unchanged(b, *before.b);
}

// The first field that differs between two events of the same type; its location is its name.
std::optional<ExplanationDifference> compareFields(const ExplainedEvent& a, const ExplainedEvent& b,
                                                   const Before& before, const DiffTolerance& tolerance) {
  for (const auto& [name, value] : a.fields) {
    if (isLocation(name) || isUndefined(a, b, before, name)) continue;
    const EventValue* other = b.find(name);
    if (!other) return ExplanationDifference{name, valueText(value), kMissing, {}};
    if (auto difference = compare(name, value, *other, tolerance)) return difference;
  }
  for (const auto& [name, value] : b.fields)
    if (!isLocation(name) && !a.find(name) && !isUndefined(a, b, before, name))
      return ExplanationDifference{name, kMissing, valueText(value), {}};
  return {};
}

// Finds the first difference.
class Walk {
 public:
  Walk(ExplanationDiff& diff, const DiffTolerance& tolerance) : diff_(diff), tolerance_(tolerance) {}

  // Returns false at the first difference.
  bool compareLists(const std::vector<ExplainedEvent>& a, const std::vector<ExplainedEvent>& b, const std::string& at) {
    const std::size_t count = std::max(a.size(), b.size());
    for (std::size_t i = 0; i < count; ++i) {
      const std::string nameA = i < a.size() ? eventName(a, i) : kMissing;
      const std::string nameB = i < b.size() ? eventName(b, i) : kMissing;
      if (i >= a.size() || i >= b.size() || a[i].type != b[i].type) {
        diff_.before = path_;
        diff_.first = {at + (at.empty() ? "event " : ", event ") + std::to_string(i + 1), nameA, nameB, {}};
        return false;
      }
      path_.push_back(nameA);
      const bool equal =
          compareEvents(a[i], b[i], at.empty() ? nameA : at + ", " + nameA, {findBefore(a, a[i]), findBefore(b, b[i])});
      path_.pop_back();
      if (!equal) return false;
    }
    return true;
  }

 private:
  bool compareEvents(const ExplainedEvent& a, const ExplainedEvent& b, const std::string& at, const Before& before) {
    if (auto difference = compareFields(a, b, before, tolerance_)) {
      difference->location = at + ": " + difference->location;
      diff_.before = path_;
      diff_.first = std::move(*difference);
      return false;
    }
    diff_.equalEvents++;
    return compareLists(a.children, b.children, at);
  }

  ExplanationDiff& diff_;
  const DiffTolerance& tolerance_;
  std::vector<std::string> path_;  // names of the enclosing events
};

// Finds all differences.
class Marks {
 public:
  explicit Marks(const DiffTolerance& tolerance) : tolerance_(tolerance) {}

  void compareLists(const std::vector<ExplainedEvent>& a, const std::vector<ExplainedEvent>& b) {
    std::size_t i = 0;
    for (; i < a.size() && i < b.size() && a[i].type == b[i].type; ++i) {
      if (compareFields(a[i], b[i], {findBefore(a, a[i]), findBefore(b, b[i])}, tolerance_)) {
        found_.a.push_back(numberA_);
        found_.b.push_back(numberB_);
      }
      ++numberA_;
      ++numberB_;
      compareLists(a[i].children, b[i].children);
    }
    mark(a, i, found_.a, numberA_);
    mark(b, i, found_.b, numberB_);
  }
  DifferentEvents take() { return std::move(found_); }

 private:
  static void mark(const std::vector<ExplainedEvent>& events, std::size_t first, std::vector<std::size_t>& found,
                   std::size_t& number) {
    for (std::size_t i = first; i < events.size(); ++i) {
      found.push_back(number++);
      mark(events[i].children, 0, found, number);
    }
  }

  const DiffTolerance& tolerance_;
  DifferentEvents found_;
  std::size_t numberA_ = 0, numberB_ = 0;  // of the next event
};

void compareFacts(ExplanationDiff& diff, const PixelExplanation& a, const PixelExplanation& b) {
  const auto add = [&](const char* name, const std::string& x, const std::string& y) {
    if (x != y) diff.facts.push_back({name, x, y, {}});
  };
  add("version", a.version, b.version);
  add("scene", a.scene, b.scene);
  add("program", a.program, b.program);
  add("parameters", a.parameters, b.parameters);
  add("camera", a.camera, b.camera);
  add("device", a.device, b.device);
  add("driver", a.driver, b.driver);
  const auto pair = [](uvec2 v) { return fmt::format("{}x{}", v.x, v.y); };
  add("size", pair(a.size), pair(b.size));
  add("pixel", fmt::format("{},{}", a.pixel.x, a.pixel.y), fmt::format("{},{}", b.pixel.x, b.pixel.y));
  add(a.frames ? "frame" : "sample", std::to_string(a.sample), std::to_string(b.sample));
  add("planned samples", std::to_string(a.plannedSamples), std::to_string(b.plannedSamples));
  add("seed", std::to_string(a.seed), std::to_string(b.seed));
}

}  // namespace

std::string valueText(const EventValue& value) { return std::visit(ToText(), value); }

std::string eventName(const std::vector<ExplainedEvent>& events, std::size_t index) {
  const ExplainedEvent& event = events[index];
  if (event.type == "payload" || event.type == "data") return event.type + " " + event.text("when");
  if (const std::string stage = event.text("stage");
      !stage.empty() && event.type != "ray" && event.type != "call" && event.type != "store")
    return event.type + " " + stage;
  const auto sameType = [&](const ExplainedEvent& other) { return other.type == event.type; };
  const auto begin = events.begin();
  if (std::ranges::count_if(events, sameType) == 1 && event.type != "ray") return event.type;
  return fmt::format("{} {}", event.type,
                     1 + std::count_if(begin, begin + static_cast<std::ptrdiff_t>(index), sameType));
}

ExplanationDiff diffExplanations(const PixelExplanation& a, const PixelExplanation& b, const DiffTolerance& tolerance) {
  ExplanationDiff diff;
  compareFacts(diff, a, b);
  Walk(diff, tolerance).compareLists(a.events, b.events, {});
  for (const ExplainedOutput& output : a.outputs) {
    const auto other = std::ranges::find(b.outputs, output.name, &ExplainedOutput::name);
    const auto floats = [](const vec4& v) { return EventValue(std::vector<float>{v.x, v.y, v.z, v.w}); };
    if (other == b.outputs.end()) {
      diff.outputs.push_back({output.name, valueText(floats(output.value)), kMissing, {}});
    } else if (auto difference = compare(output.name, floats(output.value), floats(other->value), tolerance)) {
      diff.outputs.push_back(std::move(*difference));
    }
  }
  return diff;
}

DifferentEvents differentEvents(const PixelExplanation& a, const PixelExplanation& b, const DiffTolerance& tolerance) {
  Marks marks(tolerance);
  marks.compareLists(a.events, b.events);
  return marks.take();
}

}  // namespace quintet::job
