// SPDX-License-Identifier: Apache-2.0
// The panels beside the image. Each shows a part of the state and applies commands.
#ifndef QUINTET_APPS_VIEWER_PANELS_PANELS_H
#define QUINTET_APPS_VIEWER_PANELS_PANELS_H

#include "view_state.h"

namespace quintet::viewer {

void scenePanel(ViewState& state);      // tree of instances, materials and lights
void selectionPanel(ViewState& state);  // properties of the selected object
void explainPanel(ViewState& state);    // tree of the explained pixel's rays
void printedPanel(ViewState& state);    // what the program prints
void environmentPanel(ViewState& state);
void parametersPanel(ViewState& state);  // of the program
void cameraPanel(ViewState& state);      // cameras of the file, lens, bookmarks
void displayPanel(ViewState& state);     // output, exposure, tone mapping, false color, histogram
void comparePanel(ViewState& state);
void statisticsPanel(ViewState& state);

// Properties of the selected object, for selectionPanel().
void instanceProperties(ViewState& state, std::size_t instance);
void materialProperties(ViewState& state, std::size_t material);
void lightProperties(ViewState& state, std::size_t light);

}  // namespace quintet::viewer
#endif
