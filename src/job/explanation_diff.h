// SPDX-License-Identifier: Apache-2.0
// Where two explanations of a sample separate: of two builds, devices, parameters or programs.
#ifndef QUINTET_JOB_EXPLANATION_DIFF_H
#define QUINTET_JOB_EXPLANATION_DIFF_H

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "job/pixel_explanation.h"

namespace quintet::job {

struct DiffTolerance {
  float relative = 1e-4f;  // of the larger magnitude; of vectors, of the longer one
  float absolute = 1e-6f;
};

// A difference between two explanations A and B.
struct ExplanationDifference {
  std::string location;        // "ray 2, closest-hit, payload after: payload.color"
  std::string a, b;            // the values; "missing" if there is none
  std::optional<float> error;  // the absolute difference of numbers; unset for other values
};

struct ExplanationDiff {
  std::vector<ExplanationDifference> facts;    // scene, program, device, …: what was explained
  std::optional<ExplanationDifference> first;  // the first event that differs; unset if none does
  std::vector<std::string> before;             // what A and B have in common just before it: the enclosing events
  std::size_t equalEvents = 0;                 // up to the first difference
  std::vector<ExplanationDifference> outputs;  // values of the sample that differ
  bool equal() const { return !first && outputs.empty(); }
};

// Lists of events are aligned: an event that only one of them has does not make those after it different.
// Numbers within the tolerance are equal. Source lines and files are not compared, nor are payloads and callable data before
// a call, and what the call does not change: members that a program has not written are undefined.
ExplanationDiff diffExplanations(const PixelExplanation& a, const PixelExplanation& b,
                                 const DiffTolerance& tolerance = {});

// The events that differ in a field, or that only one explanation has, with those in them. By their numbers in the
// order of forEachEvent(), ascending.
struct DifferentEvents {
  std::vector<std::size_t> a, b;
  std::optional<std::size_t> firstInB;  // the event of B in ExplanationDiff::first; unset if B lacks it
};
DifferentEvents differentEvents(const PixelExplanation& a, const PixelExplanation& b,
                                const DiffTolerance& tolerance = {});

// A value as text: floats with up to 6 digits.
std::string valueText(const EventValue& value);

// The name of an event in its list: "ray 2", "light", "closest-hit surface.rchit".
std::string eventName(const std::vector<ExplainedEvent>& events, std::size_t index);

}  // namespace quintet::job
#endif
