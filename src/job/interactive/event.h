// SPDX-License-Identifier: Apache-2.0
// What happened in a session since the last step, as plain data.
#ifndef QUINTET_JOB_INTERACTIVE_EVENT_H
#define QUINTET_JOB_INTERACTIVE_EVENT_H

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/diagnostic.h"
#include "base/math.h"
#include "job/observer.h"

namespace quintet::job::interactive {

struct Restarted {};  // a change has discarded the samples
struct ImageUpdated {
  std::uint64_t samples = 0;  // per pixel, or frames
  uvec2 size{0};              // pixels of this image
  unsigned factor = 1;        // by which its sides are smaller than those of the session
  bool complete = false;      // all samples at full resolution
  double seconds = 0;         // in which these samples were rendered, wall clock
};
struct ProgramReloaded {
  std::string files;  // that were saved: "a.rgen, b.rchit"
};
// Of the program that is shown, or of its changed files. If one is an error, the session continues with the last
// program that compiled.
struct DiagnosticsFound {
  std::vector<Diagnostic> diagnostics;
};
// What the program printed for the pixels that SetPrint chose, since the last event of this kind or restart. Only
// images at full resolution print.
struct LinesPrinted {
  Printed printed;
};
// The device was lost, and another one or the same was opened. The session continues with all edits and settings; the
// samples are discarded.
struct DeviceReplaced {
  std::string device;   // name
  std::string message;  // why the device was lost
};
struct Note {
  std::string text;
};
struct Warning {
  std::string text;
};
// The render stopped until a command discards the samples, a file of the program is saved, or Session::refine().
struct Failed {
  std::string message;
};

using Event = std::variant<Restarted, ImageUpdated, ProgramReloaded, DiagnosticsFound, LinesPrinted, DeviceReplaced,
                           Note, Warning, Failed>;

}  // namespace quintet::job::interactive
#endif
