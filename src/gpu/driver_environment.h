// Environment variables by which drivers are told to work rightly and fast. A driver reads them
// when it is loaded, so they are set before the first instance exists.
#ifndef QUINTET_GPU_DRIVER_ENVIRONMENT_H
#define QUINTET_GPU_DRIVER_ENVIRONMENT_H

namespace quintet::gpu {

// Threads that lavapipe should use on a machine of `cores` cores.
unsigned lavapipeThreads(unsigned cores);

// Sets what docs/design/quirks.md lists, once per process; variables that the user has set stay, and
// with QUINTET_NO_DRIVER_WORKAROUNDS=1 nothing is set. Call it early in a program with threads of
// its own: setenv races with getenv in other threads.
void prepareDriverEnvironment();

}  // namespace quintet::gpu
#endif
