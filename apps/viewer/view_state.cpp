// SPDX-License-Identifier: Apache-2.0
#include "view_state.h"

#include <algorithm>
#include <utility>

namespace quintet::viewer {
namespace {

constexpr double kNoteSeconds = 4.0;
constexpr double kErrorSeconds = 10.0;
constexpr std::size_t kMaxToasts = 4;
constexpr std::size_t kMaxLog = 500;

}  // namespace

void ViewState::addMessage(Message message) {
  if (log.size() >= kMaxLog) log.erase(log.begin());
  log.push_back(message);
  const double seconds = message.kind == Message::Kind::note ? kNoteSeconds : kErrorSeconds;
  std::erase_if(toasts, [&](const Toast& toast) { return toast.message.text == message.text; });  // shown once
  if (toasts.size() >= kMaxToasts) toasts.erase(toasts.begin());
  toasts.push_back({std::move(message), time + seconds});
}

void ViewState::explainPixel(uvec2 pixel, std::uint32_t sample) {
  explain.pixel = pixel;
  explain.sample = std::min(sample, std::max(snapshot->state.samples, 1u) - 1);
  explain.revealsPanel = settings.openPanels.insert("Explain").second || !explanation;
  session->explain(pixel, explain.sample);
}

void ViewState::printPixels(const render::Region& pixels) {
  settings.openPanels.insert("Printed");
  apply(job::interactive::SetPrint{job::PrintRequest{.pixels = pixels}});
}

void ViewState::setExplanation(std::shared_ptr<const job::PixelExplanation> next, std::string command) {
  explanation = std::move(next);
  explain.command = std::move(command);
  explain.tree = explanation ? std::make_shared<const ExplanationTree>(explanation) : nullptr;
  explain.closed.clear();
  explain.row.reset();
  selectedRay.reset();
  explain.comparison.reset();
  if (explanation && explain.compares) compareExplanation(true);
}

void ViewState::selectRow(std::optional<std::size_t> row) {
  explain.row = row;
  selectedRay = row ? explain.tree->rows()[*row].ray : std::nullopt;
}

void ViewState::compareExplanation(bool on) {
  explain.compares = on && explain.kept;
  explain.comparison.reset();
  if (!explain.compares || !explain.tree) return;
  explain.comparison = compareExplanations(*explain.kept, *explain.tree);
  if (!explain.comparison->first) return;
  explain.closed.clear();
  selectRow(explain.comparison->first);
  explain.revealsRow = true;
}

}  // namespace quintet::viewer
