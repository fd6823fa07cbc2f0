// SPDX-License-Identifier: Apache-2.0
// Ctrl-C (SIGINT) and SIGTERM. Normally they end the process at once with status 128 + signal. While a GracefulStop exists,
// the first one is only recorded, and the second one ends the process. While a ProtectedWrite exists, the process ends
// after the file is complete.
#ifndef QUINTET_CLI_SIGNALS_H
#define QUINTET_CLI_SIGNALS_H

#include <sys/types.h>

namespace quintet::cli {

// The longest wait for a saved file: a signal that arrives just before the wait is noticed after this time, seconds.
inline constexpr double kSignalSeconds = 0.25;

// Once, at the start of main.
void installSignalHandlers();

// The process that forwards signals to this one (cli/supervisor.h). A signal that was sent to both counts once.
void setSupervisor(pid_t process);

class GracefulStop {
 public:
  GracefulStop();
  ~GracefulStop();
  GracefulStop(const GracefulStop&) = delete;
  GracefulStop& operator=(const GracefulStop&) = delete;

  bool requested() const;
  int exitStatus() const;  // 128 + signal, or 0 if there was none
};

class ProtectedWrite {
 public:
  ProtectedWrite();
  ~ProtectedWrite();  // ends the process if a signal arrived meanwhile
  ProtectedWrite(const ProtectedWrite&) = delete;
  ProtectedWrite& operator=(const ProtectedWrite&) = delete;
};

}  // namespace quintet::cli
#endif
