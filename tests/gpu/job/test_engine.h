// SPDX-License-Identifier: Apache-2.0
#ifndef QUINTET_TESTS_GPU_JOB_TEST_ENGINE_H
#define QUINTET_TESTS_GPU_JOB_TEST_ENGINE_H

#include "job/engine.h"

namespace quintet::job {

// Returns the engine of this process, which the first call creates, and which runDeviceTests() destroys. A static Engine would
// crash: it opens its device in a thread, after its destructor is registered, so at exit the driver unloads first.
Engine& testEngine();

}  // namespace quintet::job
#endif
