// SPDX-License-Identifier: Apache-2.0
// One process at a time renders a part: it holds the lock of the part's checkpoint (base/file_lock.h).
#ifndef QUINTET_FARM_PART_LOCK_H
#define QUINTET_FARM_PART_LOCK_H

#include <cstddef>
#include <functional>
#include <string>

#include "farm/plan.h"

namespace quintet::farm {

// Waits until no process holds the lock, as FileLock does. Throws its FileError if the lock is still held after so many
// seconds.
void waitUntilFree(const Plan& plan, std::size_t part, double seconds,
                   const std::function<void(const std::string& text)>& note = {});

}  // namespace quintet::farm
#endif
