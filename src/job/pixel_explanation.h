// SPDX-License-Identifier: Apache-2.0
// Why a sample of a pixel has its value: the tree of what the program did, as plain data. PixelExplainer records it,
// output/explanation_text.h prints it, explanation_json.h stores it, explanation_diff.h compares two of them.
#ifndef QUINTET_JOB_PIXEL_EXPLANATION_H
#define QUINTET_JOB_PIXEL_EXPLANATION_H

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"

namespace quintet::job {

using EventValue = std::variant<bool, std::int64_t, float, std::string, std::vector<float>, std::vector<std::int64_t>>;

// Something that happened on the device. Lengths are meters, positions and directions are in world space, indices are
// those of the scene. docs/explain-pixel.md lists the types with their fields.
struct ExplainedEvent {
  std::string type;
  std::vector<std::pair<std::string, EventValue>> fields;
  std::vector<ExplainedEvent> children;

  const EventValue* find(std::string_view name) const;  // null if there is no such field
  // Values of fields; the default if there is no such field, or if it has another type.
  std::string text(std::string_view name) const;
  float number(std::string_view name) const;
  std::int64_t integer(std::string_view name) const;
  bool flag(std::string_view name) const;
  vec3 vector(std::string_view name) const;
  void set(std::string name, EventValue value);  // replaces a field or appends one
  bool operator==(const ExplainedEvent&) const = default;
};

// An output of the program after the sample, for this sample alone: the value that the sample added, or the pixel's value
// if the program accumulates its frames.
struct ExplainedOutput {
  std::string name;
  vec4 value{0.0f};     // of the program as it renders images
  vec4 recorded{0.0f};  // of its instrumented variant; the same up to rounding
};

// The first operation of a sample whose result is not finite.
struct ValueOrigin {
  SourceLocation location;
  std::string stage;      // file
  std::string operation;  // "division", "sqrt", "read of an image"
  bool isNan = false;     // else the result is infinite
};

// "the result of this division is NaN"
std::string originText(const ValueOrigin& origin);

struct PixelExplanation {
  // What was explained.
  std::string scene;       // path or name
  std::string program;     // name
  std::string parameters;  // "bounces=12 clamp=0"
  std::string camera;
  std::string device, driver, version;  // version: of Quintet
  uvec2 size{0};                        // of the whole image, pixels
  uvec2 pixel{0};                       // from the top left corner
  std::uint32_t sample = 0;             // or frame
  bool frames = false;                  // the program accumulates: `sample` is a frame
  std::uint64_t plannedSamples = 0;     // per pixel; 0 if unlimited
  std::uint64_t seed = 0;

  std::vector<ExplainedOutput> outputs;
  std::vector<ExplainedEvent> events;
  bool discarded = false;  // the program discarded the sample, because its value is not finite
  // If the value is not finite, and the program is not built in: the first operation whose result is not finite.
  std::optional<ValueOrigin> origin{};
  std::uint32_t lostRecords = 0;  // that did not fit into the log
};

// A part of the first output's value: an event `contribution`, or a store if the program states no contributions.
struct Contribution {
  vec3 value{0.0f};
  std::string source;             // "background", "surface", "light sample", "store"
  std::int64_t scatterings = -1;  // -1 if unknown
  std::size_t ray = 0;  // the latest ray before a stated one, counted from 1 in the order of the traces; 0: none
};

// In the order of the program.
std::vector<Contribution> contributionsOf(const PixelExplanation& explanation);

// The sum of the contributions, in float32 and in the order of the program, as it sums them.
vec3 sumContributions(const PixelExplanation& explanation);

// Calls visit(event, depth) for each event, parents first.
template <class Visit>
void forEachEvent(const std::vector<ExplainedEvent>& events, const Visit& visit, int depth = 0) {
  for (const ExplainedEvent& event : events) {
    visit(event, depth);
    forEachEvent(event.children, visit, depth + 1);
  }
}

}  // namespace quintet::job
#endif
