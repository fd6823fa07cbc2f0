// SPDX-License-Identifier: Apache-2.0
// The system calls that a worker cannot use (seccomp): sockets, other processes, attributes of files, mounts, namespaces, kernel
// modules, and what would evade the other parts of the sandbox.
#ifndef QUINTET_LAB_SYSTEM_CALL_FILTER_H
#define QUINTET_LAB_SYSTEM_CALL_FILTER_H

#include "base/error.h"

namespace quintet::lab {

// The process cannot be restricted, although the kernel offers it.
class SandboxError : public Error {
 public:
  using Error::Error;
};

// Whether the kernel and this architecture support the filter.
bool hasSystemCallFilter();

// For this thread, later ones, and all processes that they start. Denied calls fail with EPERM; those that a caller can replace with
// ENOSYS. `ownSignals`: signals can be sent to this process only. Throws SandboxError.
void filterSystemCalls(bool ownSignals);

}  // namespace quintet::lab
#endif
