// SPDX-License-Identifier: Apache-2.0
// What the panels show and change: the session, the settings, and what the user has selected.
#ifndef QUINTET_APPS_VIEWER_VIEW_STATE_H
#define QUINTET_APPS_VIEWER_VIEW_STATE_H

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/math.h"
#include "gpu/present/line_list.h"
#include "io/image.h"
#include "job/pixel_explanation.h"
#include "overlay/ray_overlay.h"
#include "viewer/bindings.h"
#include "viewer/bookmarks.h"
#include "viewer/display.h"
#include "viewer/explanation_tree.h"
#include "viewer/navigation.h"
#include "viewer/rate_history.h"
#include "viewer/session_thread.h"
#include "viewer/settings.h"

namespace quintet::viewer {

struct Selection {
  enum class Kind { none, instance, material, light };
  Kind kind = Kind::none;
  std::size_t index = 0;
  bool operator==(const Selection&) const = default;
};

// A message above the image, which disappears.
struct Toast {
  Message message;
  double shownUntil = 0;  // ViewState::time
};

// The rays of the explained pixel over the image (overlays/rays.cpp).
struct ShownRays {
  bool enabled = true;                       // by the user
  std::optional<overlay::RayOverlay> paths;  // unset without an explanation, or if the program has a camera of its own
  gpu::LineList lines;                       // of this frame, pixels of the window
  std::shared_ptr<const job::DepthMap> depth;                // of this frame; null while it is not known
  std::shared_ptr<const job::PixelExplanation> explanation;  // for which the overlay was made
  bool depthRequested = false;                               // SessionThread::showDepth
  bool visible() const { return enabled && paths.has_value(); }
};

// How false color shows the image, and how it is compared.
struct DisplayControls {
  bool falseColor = false;
  Channel channel = Channel::luminance;
  FalseColorRange range;
  CompareMode compare = CompareMode::off;
  float split = 0.5f;  // position of the line, as a fraction of the width
  bool marksNotFinite = true;
};

// What the next click on the image does.
enum class ClickUse { select, explain, print };

// The explained pixel, and the tree of its explanation.
struct ExplainControls {
  std::optional<uvec2> pixel;                         // that was asked for last
  std::uint32_t sample = 0;                           // or frame
  std::shared_ptr<const ExplanationTree> tree;        // of ViewState::explanation; null if there is none
  std::optional<std::size_t> row;                     // selected
  std::set<std::size_t> closed;                       // rows that hide those below them
  bool revealsPanel = false, revealsRow = false;      // by scrolling, in the next frame
  std::shared_ptr<const job::PixelExplanation> kept;  // A of a comparison; null if there is none
  bool compares = false;
  std::string command;  // the command line that explains the pixel; empty if the scene had changed before it was known
  std::optional<ExplanationComparison> comparison;  // if `compares`
};

struct ViewState {
  Settings settings;
  std::filesystem::path settingsFolder;  // empty: nothing is stored
  Bookmarks bookmarks;
  SessionThread* session = nullptr;
  std::shared_ptr<const Snapshot> snapshot;
  std::shared_ptr<const Display> display;  // null before the first image

  Selection selection;
  // Of the pixel that the user explains; null if there is none. The index counts the events `ray` in the order of
  // job::forEachEvent(), from 0.
  std::shared_ptr<const job::PixelExplanation> explanation;
  std::optional<std::size_t> selectedRay;
  ExplainControls explain;
  ClickUse click = ClickUse::select;
  std::vector<Action> requests;  // of panels, for the application
  ShownRays rays;
  DisplayControls controls;
  std::string referenceFile;
  std::shared_ptr<const io::Image> reference;  // null if there is none

  double time = 0;  // seconds since the start
  float scale = 1;  // size of text and controls
  std::vector<Toast> toasts;
  std::vector<Message> log;
  bool showHelp = false, showDiagnostics = true;
  bool playing = false;
  double playStart = 0;  // `time` at which frame 0 was shown
  std::optional<uvec2> hoveredPixel;
  RateHistory imageRates, rayRates;   // images per second, million rays per second
  overlay::ImagePlacement placement;  // of the image, in the current frame
  uvec2 viewSize{0};                  // for which the window has room
  std::optional<uvec2> fixedSize;     // of the image; unset: that of the window
  bool keptSize = false;              // the image is scaled, because another size would discard samples that took long
  bool fitsImage = false;             // the user wants the size of the window now
  // On `time`: since then, there is no image, or work before the next one. Unset while the session renders.
  std::optional<double> waitingSince;
  std::optional<double> loadingSince;  // on `time`; unset unless the session is being opened
  bool stopsWork = false;              // the user ends a launch that takes too long

  bool ready() const { return snapshot->phase == Snapshot::Phase::ready; }
  void apply(job::interactive::Command command) { session->apply(std::move(command)); }
  void addMessage(Message message);
  void explainPixel(uvec2 pixel, std::uint32_t sample);  // or the last sample, if there are fewer
  void printPixels(const render::Region& pixels);
  // Null hides it. `command`: ExplainControls::command.
  void setExplanation(std::shared_ptr<const job::PixelExplanation> next, std::string command = {});
  void selectRow(std::optional<std::size_t> row);  // of the tree
  void compareExplanation(bool on);                // with ExplainControls::kept
};

}  // namespace quintet::viewer
#endif
