// SPDX-License-Identifier: Apache-2.0
#include "job/explanation_diff.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "base/sequence_alignment.h"

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

// The distance of numbers; unset for other values.
std::optional<float> distanceOf(const EventValue& a, const EventValue& b) {
  const std::vector<float> x = components(a), y = components(b);
  if (x.empty() || x.size() != y.size()) return {};
  return distance(x, y);
}

bool areEqual(const EventValue& a, const EventValue& b, const DiffTolerance& tolerance) {
  if (a == b) return true;
  const std::vector<float> x = components(a), y = components(b);
  if (x.empty() || x.size() != y.size()) return false;
  return distance(x, y) <= tolerance.absolute + tolerance.relative * std::max(size(x), size(y));
}

// `a`, `b`: null if there is no value.
ExplanationDifference differenceOf(std::string location, const EventValue* a, const EventValue* b) {
  return {std::move(location), a ? valueText(*a) : kMissing, b ? valueText(*b) : kMissing,
          a && b ? distanceOf(*a, *b) : std::nullopt};
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

// The name of the first field that differs between two events of the same type; null if they are equal.
const std::string* differentField(const ExplainedEvent& a, const ExplainedEvent& b, const Before& before,
                                  const DiffTolerance& tolerance) {
  for (const auto& [name, value] : a.fields) {
    if (isLocation(name) || isUndefined(a, b, before, name)) continue;
    const EventValue* other = b.find(name);
    if (!other || !areEqual(value, *other, tolerance)) return &name;
  }
  for (const auto& [name, value] : b.fields)
    if (!isLocation(name) && !a.find(name) && !isUndefined(a, b, before, name)) return &name;
  return nullptr;
}

// What distinguishes events of one type: the kind of ray, the stage, the output, …; empty if nothing does.
std::string_view labelOf(const ExplainedEvent& event) {
  for (const char* name : {"rayType", "records", "callable", "output", "source", "light", "lobe", "stage"})
    if (const EventValue* value = event.find(name))
      if (const auto* text = std::get_if<std::string>(value)) return *text;
  return {};
}

// A list of events with the values before the calls.
struct EventList {
  explicit EventList(const std::vector<ExplainedEvent>& list) : events(list) {
    for (const ExplainedEvent& event : list) before.push_back(findBefore(list, event));
  }
  const std::vector<ExplainedEvent>& events;
  std::vector<const ExplainedEvent*> before;  // findBefore()
};

// Compares all events, and finds the first difference.
class Comparison {
 public:
  explicit Comparison(const DiffTolerance& tolerance) : tolerance_(tolerance) {}

  void compareLists(const std::vector<ExplainedEvent>& eventsA, const std::vector<ExplainedEvent>& eventsB,
                    const std::string& at) {
    const EventList a(eventsA), b(eventsB);
    const std::vector<AlignedPair> pairs = alignSequences(
        eventsA.size(), eventsB.size(), [&](std::size_t i, std::size_t j) { return similarity(a, i, b, j); });
    for (auto pair = pairs.begin(); pair != pairs.end(); ++pair) {
      if (pair->a && pair->b) {
        compareEvents(a, *pair->a, b, *pair->b, at);
        continue;
      }
      if (!diff_.first) reportUnpaired(a, b, {pair, pairs.end()}, at);
      if (pair->a)
        mark(eventsA[*pair->a], found_.a, numberA_);
      else
        mark(eventsB[*pair->b], found_.b, numberB_);
    }
  }
  ExplanationDiff takeDiff() { return std::move(diff_); }
  DifferentEvents takeEvents() { return std::move(found_); }

 private:
  const std::string* differentFieldOf(const EventList& a, std::size_t i, const EventList& b, std::size_t j) const {
    return differentField(a.events[i], b.events[j], {a.before[i], b.before[j]}, tolerance_);
  }

  // An equal event counts as much as two with the same label, and they as much as two of the same type.
  unsigned similarity(const EventList& a, std::size_t i, const EventList& b, std::size_t j) const {
    const ExplainedEvent &x = a.events[i], &y = b.events[j];
    if (x.type != y.type || x.text("when") != y.text("when")) return 0;
    if (!differentFieldOf(a, i, b, j)) return kMostSimilar;
    return labelOf(x) == labelOf(y) ? kMostSimilar / 2 : kMostSimilar / 4;
  }

  void compareEvents(const EventList& a, std::size_t i, const EventList& b, std::size_t j, const std::string& at) {
    const ExplainedEvent &x = a.events[i], &y = b.events[j];
    const std::string name = diff_.first ? "" : eventName(a.events, i);
    const std::string here = at.empty() ? name : at + ", " + name;
    path_.push_back(name);
    if (const std::string* field = differentFieldOf(a, i, b, j)) {
      if (!diff_.first) {
        diff_.first = differenceOf(here + ": " + *field, x.find(*field), y.find(*field));
        diff_.before = path_;
        found_.firstInB = numberB_;
      }
      found_.a.push_back(numberA_);
      found_.b.push_back(numberB_);
    } else if (!diff_.first) {
      diff_.equalEvents++;
    }
    ++numberA_;
    ++numberB_;
    compareLists(x.children, y.children, here);
    path_.pop_back();
  }

  // The first difference is that events have no partner. `rest`: from the first one of them on.
  void reportUnpaired(const EventList& a, const EventList& b, std::span<const AlignedPair> rest,
                      const std::string& at) {
    const AlignedPair& first = rest.front();
    const std::string event = fmt::format("event {}", 1 + first.a.value_or(first.b.value_or(0)));
    diff_.first = {at.empty() ? event : at + ", " + event, kMissing, kMissing, {}};
    diff_.before = path_;
    if (first.a) diff_.first->a = eventName(a.events, *first.a);
    // A different event of B at the same place.
    const auto other = std::ranges::find_if(rest, [](const AlignedPair& pair) { return pair.b.has_value(); });
    if (other == rest.end() || other->a) return;
    diff_.first->b = eventName(b.events, *other->b);
    found_.firstInB = numberB_;
  }

  // The event and those in it.
  static void mark(const ExplainedEvent& event, std::vector<std::size_t>& found, std::size_t& number) {
    found.push_back(number++);
    for (const ExplainedEvent& child : event.children) mark(child, found, number);
  }

  const DiffTolerance& tolerance_;
  ExplanationDiff diff_;
  DifferentEvents found_;
  std::vector<std::string> path_;          // names of the enclosing events, up to the first difference
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
  Comparison comparison(tolerance);
  comparison.compareLists(a.events, b.events, {});
  ExplanationDiff diff = comparison.takeDiff();
  compareFacts(diff, a, b);
  for (const ExplainedOutput& output : a.outputs) {
    const auto other = std::ranges::find(b.outputs, output.name, &ExplainedOutput::name);
    const auto floats = [](const vec4& v) { return EventValue(std::vector<float>{v.x, v.y, v.z, v.w}); };
    const EventValue value = floats(output.value);
    const EventValue otherValue = other == b.outputs.end() ? EventValue() : floats(other->value);
    if (other == b.outputs.end())
      diff.outputs.push_back(differenceOf(output.name, &value, nullptr));
    else if (!areEqual(value, otherValue, tolerance))
      diff.outputs.push_back(differenceOf(output.name, &value, &otherValue));
  }
  return diff;
}

DifferentEvents differentEvents(const PixelExplanation& a, const PixelExplanation& b, const DiffTolerance& tolerance) {
  Comparison comparison(tolerance);
  comparison.compareLists(a.events, b.events, {});
  return comparison.takeEvents();
}

}  // namespace quintet::job
