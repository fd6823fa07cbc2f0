// Ctrl-C (SIGINT) and SIGTERM. Ordinarily they end the process at once with status 128 + signal; while a
// GracefulStop lives, the first one is only noted and the second one ends the process; while a
// ProtectedWrite lives, the end waits until the file is complete.
#ifndef QUINTET_APP_SIGNALS_H
#define QUINTET_APP_SIGNALS_H

namespace quintet::app {

// Once, at the start of main.
void installSignalHandlers();

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
  ~ProtectedWrite();  // leaves the process if a signal asked for it meanwhile
  ProtectedWrite(const ProtectedWrite&) = delete;
  ProtectedWrite& operator=(const ProtectedWrite&) = delete;
};

}  // namespace quintet::app
#endif
