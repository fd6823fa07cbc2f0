// SPDX-License-Identifier: Apache-2.0
// What the server and its workers say to each other, besides what they forward: FrameKind::control.
#ifndef QUINTET_LAB_WORKER_CONTROL_H
#define QUINTET_LAB_WORKER_CONTROL_H

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lab/api.h"

namespace quintet::lab {

// Exit status of a worker whose device hangs. WorkerHung precedes it.
inline constexpr int kHungStatus = 70;

// The first message to a worker.
struct WorkerSettings {
  std::string folder;              // of the project
  std::vector<std::string> files;  // that belong to it; empty means all
  std::string device;              // job::EngineOptions::device
  bool contained = true;           // in a sandbox (sandbox.h)
  std::uint64_t memory = 0;        // bytes that the process can use; 0: no limit
  std::int64_t process = 0;        // of the worker, as the server sees it
  LabDefaults defaults;
};
std::string settingsJson(const WorkerSettings& settings);
WorkerSettings parseSettings(std::string_view json);  // throws Error

// What else a control message says.
enum class Control {
  hold,  // to the worker: the next `open` waits until a file of its program is saved; `message` is that of the last `loads`
  loads,  // from the worker: it reads the program; `message` is the time, seconds since 1970
  alive,  // from the worker: it has finished what it did
  hung,   // from the worker: a launch did not end in time; `message` says which
};
struct ControlMessage {
  Control control = Control::alive;
  std::string message;
};
std::string controlJson(const ControlMessage& message);
ControlMessage parseControl(std::string_view json);  // throws Error

}  // namespace quintet::lab
#endif
