// SPDX-License-Identifier: Apache-2.0
#include "farm/part_lock.h"

#include <chrono>
#include <thread>

#include "base/error.h"
#include "base/file_lock.h"
#include "base/stopwatch.h"

namespace quintet::farm {

void waitUntilFree(const Plan& plan, std::size_t part, double seconds) {
  const Stopwatch clock;
  for (;;) {
    try {
      const FileLock probe(checkpointFile(plan, part));
      return;
    } catch (const FileError&) {
      if (clock.seconds() >= seconds) throw;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
}

}  // namespace quintet::farm
