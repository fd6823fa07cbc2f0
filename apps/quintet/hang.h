// Launches that never end. The driver's threads cannot be stopped, and tearing the device down would wait for them:
// so the process says what has happened and leaves without it.
#ifndef QUINTET_APP_HANG_H
#define QUINTET_APP_HANG_H

#include <functional>

#include "program/program.h"

namespace quintet::app {

// Runs `launches`. If one of them does not end in time (gpu::TimeoutError): one line on standard error, with `json`
// an array with one diagnostic on standard output, and the process ends with status 1.
void withoutHanging(const program::Program& program, bool json, const std::function<void()>& launches);

}  // namespace quintet::app
#endif
