// SPDX-License-Identifier: Apache-2.0
#include "farm/part_lock.h"

#include "base/file_lock.h"

namespace quintet::farm {

void waitUntilFree(const Plan& plan, std::size_t part, double seconds,
                   const std::function<void(const std::string& text)>& note) {
  const FileLock probe(checkpointFile(plan, part), seconds, note);
}

}  // namespace quintet::farm
