// SPDX-License-Identifier: Apache-2.0
// What is drawn over the image or instead of it.
#ifndef QUINTET_APPS_VIEWER_OVERLAYS_OVERLAYS_H
#define QUINTET_APPS_VIEWER_OVERLAYS_OVERLAYS_H

#include <string>
#include <vector>

#include <imgui.h>

#include "base/math.h"
#include "view_state.h"

namespace quintet::viewer {

// White text and lines over an image are readable on a shade.
constexpr ImU32 kShade = IM_COL32(0, 0, 0, 150);
constexpr ImU32 kWhite = IM_COL32(255, 255, 255, 255);

// A rectangle of the window, screen coordinates.
struct Area {
  vec2 origin{0.0f};
  vec2 size{0.0f};
};

// Without a scene: recent files and lessons.
struct Lesson {
  std::string program;  // "lessons/05_shadow"
  std::string title;    // "05 · shadow"
  std::string text;
};
std::vector<Lesson> lessons();  // of the built-in programs
void startScreen(ViewState& state, const Area& area, const std::vector<Lesson>& lessons);

void loadingScreen(const ViewState& state, const Area& area);
void failureScreen(ViewState& state, const Area& area);

void selectionOutline(const ViewState& state, const Area& area);  // a box around the selected object
void explainedPixel(const ViewState& state, const Area& area);    // a mark on it, and on the pixels that print
void notFinitePixels(const ViewState& state, const Area& area);   // a mark on each of them
void sizeNote(ViewState& state, const Area& area);                // the image is scaled, and how to change that
void waitingNote(ViewState& state, const Area& area);   // what the session does before the next image, and how long
void legend(const ViewState& state, const Area& area);  // of false color
void splitLine(ViewState& state, const Area& area);     // of the comparison; can be dragged

// The rays of the explained pixel.
void updateRays(ViewState& state);                            // after a change of the explanation or the program
void rayLines(ViewState& state, const Area& area);            // ViewState::rays, drawn where they are in the order
void rayLegendBox(const ViewState& state, const Area& area);  // what the colors mean
// Selects the ray at a position of the window, or clears the selection if the ray is selected. Returns false if there
// is none.
bool selectRay(ViewState& state, vec2 position);

void diagnosticsDrawer(ViewState& state, const Area& area);  // problems of the program, with file and line
void toasts(ViewState& state, const Area& area);
void helpWindow(ViewState& state);
void statusBar(const ViewState& state, const Area& area);
void animationBar(ViewState& state, const Area& area);

// Heights of the bars, screen coordinates.
float statusBarHeight();
float animationBarHeight();

}  // namespace quintet::viewer
#endif
