// SPDX-License-Identifier: Apache-2.0
// Controls of the panels. Each shows a value of the session, which changes some time after the user has changed the
// control; until then the control shows what the user chose. They return true if the user changed the value.
#ifndef QUINTET_APPS_VIEWER_GUI_WIDGETS_H
#define QUINTET_APPS_VIEWER_GUI_WIDGETS_H

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.h"

namespace quintet::viewer {

// How a number is edited.
struct NumberRange {
  double least = -1e30, most = 1e30;  // a slider if both are moderate, else a field that is dragged
  bool logarithmic = false;
  bool whole = false;
  std::string_view unit = {};  // shown after a single number
};

// Width of the labels, as a part of the row.
constexpr float kLabelShare = 0.44f;

// Labels stand to the left of the controls, unless they start with "##". `help` is a tooltip; empty means none.
bool numberField(const char* label, double& value, const NumberRange& range, std::string_view help = {});
bool vectorField(const char* label, double* values, int count, const NumberRange& range, std::string_view help = {});
bool colorField(const char* label, vec3& linear, std::string_view help = {});  // linear Rec. 709, ≥ 0
bool checkBox(const char* label, bool& value, std::string_view help = {});
// `index`: of `names`; those out of range show an empty text.
bool choiceField(const char* label, std::size_t& index, const std::vector<std::string>& names,
                 std::string_view help = {});
bool textField(const char* label, std::string& value, std::string_view help = {});    // true when the edit ends
bool searchField(const char* label, std::string& value, std::string_view help = {});  // true while the user types
// `width`: pixels; 0 means that of the label.
bool button(const char* label, std::string_view help = {}, bool enabled = true, float width = 0);
void sameLineIfFits(const char* label);                     // the next button() stays in this row if its label has room
void textRow(const char* label, const std::string& value);  // a value that cannot be edited
// A row of a list; `selected` rows have the color of selected controls. Returns true if it was clicked.
bool listRow(const char* label, bool selected);
// The text, or as much of its start as fits with "..." after it. `width`: pixels of the screen.
std::string fittingText(std::string_view text, float width);
void tooltip(std::string_view text);  // of the last control
// A header that opens and closes. The state is the caller's.
bool section(const char* label, bool& open);
void endSections();  // the following controls belong to none

// The user has released a control since the last call: the next change is a new step of undo.
bool takeEditEnd();

// Forgets values that the session has not confirmed, for example after undo.
void forgetPendingValues();

// Called with the name ("Parameters/geometric") and the rectangle of each control, in pixels, in every frame; null
// disables it. For tests, which must know where to click.
using WidgetLog = std::function<void(const std::string& name, vec2 least, vec2 most)>;
void setWidgetLog(WidgetLog log);
void logControl(const char* label);  // for a control that none of the functions above makes: the last one
void logControlAt(const char* label, vec2 least, vec2 most);  // for a rectangle of any kind

}  // namespace quintet::viewer
#endif
