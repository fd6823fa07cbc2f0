// SPDX-License-Identifier: Apache-2.0
// An explanation of a pixel as rows of a tree: each ray, and below it what its shaders and the shader that traced it
// did.
#ifndef QUINTET_VIEWER_EXPLANATION_TREE_H
#define QUINTET_VIEWER_EXPLANATION_TREE_H

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "job/explanation_diff.h"
#include "job/pixel_explanation.h"

namespace quintet::viewer {

struct ExplanationRow {
  const job::ExplainedEvent* event = nullptr;
  std::size_t number = 0;  // of the event in the order of job::forEachEvent(), from 0
  int depth = 0;           // in the tree
  std::size_t end = 0;     // number of the first row after those below this one
  std::string name;        // "Ray 2", "light sample"
  std::string summary;     // one line: "shadow: hits \"floor\", 2.5 m"
  // The ray of the row, else the one that it belongs to: its number among the rays, from 0.
  std::optional<std::size_t> ray;
  std::optional<vec3> contribution;  // that the event and those below it add to the value of the sample
};

// A field of an event, or a member of the payload.
struct ExplanationField {
  std::string name;  // "shading normal", "payload.color"
  std::string value;
  std::string before;  // of a payload or callable data: the value before the call, if it differs
};

class ExplanationTree {
 public:
  // `explanation` must not be null.
  explicit ExplanationTree(std::shared_ptr<const job::PixelExplanation> explanation);

  const std::shared_ptr<const job::PixelExplanation>& explanation() const { return explanation_; }
  const std::vector<ExplanationRow>& rows() const { return rows_; }
  const vec3& contributionSum() const { return contributionSum_; }  // job::sumContributions()
  bool sumDiffers() const { return sumDiffers_; }                   // output::sumDiffers()
  // The row of a ray; rows().size() if there is none.
  std::size_t rowOfRay(std::size_t ray) const;
  // The row that shows the event with this number: its own, or that of the call whose payload it is.
  std::size_t rowOfEvent(std::size_t number) const { return rowOfEvent_.at(number); }

 private:
  std::shared_ptr<const job::PixelExplanation> explanation_;
  std::vector<ExplanationRow> rows_;
  std::vector<std::size_t> rowOfEvent_;  // by the number of the event
  vec3 contributionSum_{0.0f};
  bool sumDiffers_ = false;
};

// The difference between an explanation A and the one of a tree, B.
struct ExplanationComparison {
  job::ExplanationDiff diff;
  std::vector<bool> differs;  // by row of the tree
  // The row of ExplanationDiff::first; unset if there is none, or if B lacks the event.
  std::optional<std::size_t> first;
};
ExplanationComparison compareExplanations(const job::PixelExplanation& a, const ExplanationTree& b);

// All fields of an event; of a ray and a call, also the members of the payload or data. Shader and source line are
// last.
std::vector<ExplanationField> fieldsOf(const job::ExplainedEvent& event);

}  // namespace quintet::viewer
#endif
