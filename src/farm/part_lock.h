// SPDX-License-Identifier: Apache-2.0
// One process at a time renders a part: it holds the lock of the part's checkpoint (base/file_lock.h).
#ifndef QUINTET_FARM_PART_LOCK_H
#define QUINTET_FARM_PART_LOCK_H

#include <cstddef>

#include "farm/plan.h"

namespace quintet::farm {

// Waits until no process holds the lock, for example because one that was killed has not ended yet. Throws the FileError of
// the lock, which names the process, if it is still held after so many seconds.
void waitUntilFree(const Plan& plan, std::size_t part, double seconds);

}  // namespace quintet::farm
#endif
