// SPDX-License-Identifier: Apache-2.0
// Starts the process of a worker, which is the same executable with the option kWorkerOption, and finds out how it ended. Where
// the kernel allows it, the worker is the first process of a namespace: with it, all that it has started ends.
#ifndef QUINTET_LAB_WORKER_PROCESS_H
#define QUINTET_LAB_WORKER_PROCESS_H

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <optional>

#include "lab/session_supervisor.h"

namespace quintet::lab {

// The only argument of a worker. Its socket is kWorkerSocket.
inline constexpr const char* kWorkerOption = "--worker-of-quintet-lab";
inline constexpr int kWorkerSocket = 3;

struct WorkerProcess {
  pid_t process = -1;
  int socket = -1;  // of the server; the caller closes it
};

// The worker inherits no other file of this process but standard error. On a CPU, its driver compiles fast instead of optimizing,
// unless the environment variable GALLIVM_PERF exists. Without `contained`, it has no namespaces of its own. Throws Error.
WorkerProcess startWorkerProcess(const std::filesystem::path& executable, bool contained);

// In a worker: a signal ends the first process of a namespace only if a handler does it. The handlers end it with kSignalStatus + the
// signal, which takeWorkerEnd() knows.
inline constexpr int kSignalStatus = 128;
void endBySignals();

// Bytes in physical memory of a worker; 0 if unknown.
std::uint64_t workerMemory(pid_t process);

// How the process ended; nothing while it runs. Does not wait. The process id is then free.
std::optional<WorkerEnd> takeWorkerEnd(pid_t process);

}  // namespace quintet::lab
#endif
