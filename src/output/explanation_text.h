// SPDX-License-Identifier: Apache-2.0
// What `quintet explain-pixel` prints: an explanation as a tree, or where two of them separate.
#ifndef QUINTET_OUTPUT_EXPLANATION_TEXT_H
#define QUINTET_OUTPUT_EXPLANATION_TEXT_H

#include <cstddef>
#include <string>
#include <string_view>

#include "job/explanation_diff.h"
#include "job/pixel_explanation.h"

namespace quintet::output {

// `width`: columns of the terminal, at least 40. `payloads`: show the payloads also of programs that state their
// contributions; other programs always show them.
std::string explanationText(const job::PixelExplanation& explanation, std::size_t width, bool payloads = false);

// A field as the text shows it: numbers with `digits` digits, vectors without parentheses. Empty if there is no such
// field.
std::string fieldText(const job::ExplainedEvent& event, std::string_view name, int digits = 5);

// Whether rounding explains the difference of two values.
bool isRounding(const vec3& a, const vec3& b);

// Whether the sum of the contributions is not the value of the first output, by more than rounding. A discarded sample
// has no value, so its contributions need not sum to it.
bool sumDiffers(const job::PixelExplanation& explanation);

// `a`, `b`: names of the explanations.
std::string explanationDiffText(const job::ExplanationDiff& diff, const std::string& a, const std::string& b,
                                std::size_t width);
std::string explanationDiffJson(const job::ExplanationDiff& diff, const std::string& a, const std::string& b);

}  // namespace quintet::output
#endif
