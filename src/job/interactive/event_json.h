// SPDX-License-Identifier: Apache-2.0
// Events of sessions as lines of JSON: {"event":"image","samples":4,...}. docs/viewer.md lists them.
#ifndef QUINTET_JOB_INTERACTIVE_EVENT_JSON_H
#define QUINTET_JOB_INTERACTIVE_EVENT_JSON_H

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "job/interactive/event.h"
#include "job/interactive/picking.h"
#include "job/pixel_explanation.h"

namespace quintet::job::interactive {

// All without a line break.
std::string eventJson(const Event& event);
std::string savedJson(const std::string& file);  // a script wrote an image
// A script picked a pixel. The names are those to which the indices of `pick` refer.
std::string pickedJson(uvec2 pixel, const std::optional<Pick>& pick, const std::vector<std::string>& instanceNames,
                       const std::vector<std::string>& materialNames);
// A script explained a pixel. `file`: the file that has the explanation; if it is empty, the event has it.
std::string explainedJson(const PixelExplanation& explanation, const std::string& file);
std::string failedJson(std::uint64_t line, const std::string& message);  // a line of a script failed

}  // namespace quintet::job::interactive
#endif
