// SPDX-License-Identifier: Apache-2.0
// Explanations and search results of jobs as data of the public API.
#include <algorithm>

#include "api/impl.h"
#include "job/explanation_json.h"
#include "output/explanation_text.h"

namespace quintet {
namespace {

constexpr std::size_t kTextWidth = 100;  // columns

Event toApi(const job::ExplainedEvent& event) {
  Event result{event.type, event.fields, {}};
  for (const job::ExplainedEvent& child : event.children) result.children.push_back(toApi(child));
  return result;
}

std::vector<FoundSample> toApi(const std::vector<job::FoundSample>& found) {
  std::vector<FoundSample> result;
  for (const job::FoundSample& sample : found) {
    const job::SampleCause& cause = sample.cause;
    result.push_back({.x = sample.pixel.x,
                      .y = sample.pixel.y,
                      .sample = sample.sample,
                      .value = fromGlm(sample.value),
                      .luminance = sample.luminance,
                      .level = sample.level,
                      .bounce = cause.bounce,
                      .lobe = cause.lobe,
                      .material = cause.material,
                      .instance = cause.instance,
                      .event = cause.event,
                      .field = cause.field,
                      .lobeMaterial = cause.lobeMaterial,
                      .pixels = sample.groupPixels,
                      .samples = sample.groupSamples,
                      .firstX = sample.least.x,
                      .firstY = sample.least.y,
                      .lastX = sample.most.x,
                      .lastY = sample.most.y});
  }
  return result;
}

}  // namespace

std::vector<PrintedLine> toApi(const std::vector<job::PrintedLine>& lines) {
  std::vector<PrintedLine> result;
  for (const job::PrintedLine& line : lines)
    result.push_back(
        {line.pixel.x, line.pixel.y, line.frame, line.sample, line.location.file, line.location.line, line.text});
  return result;
}

Explanation toApi(const job::PixelExplanation& explanation) {
  Explanation result;
  result.x = explanation.pixel.x;
  result.y = explanation.pixel.y;
  result.sample = explanation.sample;
  result.frames = explanation.frames;
  for (const job::ExplainedOutput& output : explanation.outputs)
    result.outputs.push_back({output.name, fromGlm(output.value), fromGlm(output.recorded)});
  for (const job::ExplainedEvent& event : explanation.events) result.events.push_back(toApi(event));
  for (const job::Contribution& contribution : contributionsOf(explanation))
    result.contributions.push_back({fromGlm(contribution.value), contribution.source, contribution.scatterings});
  result.discarded = explanation.discarded;
  result.lostEvents = explanation.lostRecords;
  result.text = output::explanationText(explanation, kTextWidth);
  result.json = job::explanationJson(explanation);
  return result;
}

SearchReport toApi(const job::SearchResult& result) {
  return {.notFinite = toApi(result.notFinite),
          .fireflies = toApi(result.fireflies),
          .notFiniteCount = result.notFiniteCount,
          .fireflyCount = result.fireflyCount,
          .samples = result.samples,
          .canceled = result.interrupted};
}

}  // namespace quintet
