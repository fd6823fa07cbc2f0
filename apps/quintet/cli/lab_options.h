// SPDX-License-Identifier: Apache-2.0
// The options of `quintet lab` and of the program `quintet-lab`, the server.
#ifndef QUINTET_CLI_LAB_OPTIONS_H
#define QUINTET_CLI_LAB_OPTIONS_H

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "base/math.h"
#include "cli/command.h"
#include "cli/option_table.h"

namespace quintet::cli {

inline constexpr std::uint16_t kLabPort = 8420;  // unless it is in use

struct LabOptions {
  std::string target;                 // folder, program or scene; may be empty
  std::string bind = "127.0.0.1";     // IP address
  std::optional<std::uint16_t> port;  // unset: kLabPort, or a free one if it is in use
  bool noOpen = false;                // do not start a browser
  std::string device;
  double timeout = 30;   // seconds that a launch may take
  double idle = 600;     // seconds without a command, after which a worker ends
  uvec2 size{640, 360};  // pixels, of a new session
  std::uint32_t samples = 64;
  std::uint32_t sessions = 16;  // that can be open at a time
  std::size_t maxMemory = 0;    // bytes that the process of a page can use; 0: half of the machine's memory
  bool noSandbox = false;       // processes of pages are not restricted
};

// Values as text, before they are converted.
struct LabTexts {
  std::string port, timeout, idle, size, samples, sessions, maxMemory;
};

OptionTable labOptionTable(LabOptions& options, LabTexts& texts);

// Empty: --help was requested and printed. Throws UsageError.
std::optional<LabOptions> parseLabOptions(Arguments arguments);

}  // namespace quintet::cli
#endif
