// SPDX-License-Identifier: Apache-2.0
#include "base/memory_budget.h"

#include <fmt/format.h>

#include "base/memory.h"
#include "base/text.h"

namespace quintet {

MemoryBudget::MemoryBudget(const std::filesystem::path& file, std::size_t limit, Remedy remedy)
    : file_(file), limit_(limit ? limit : machineMemory() / 5 * 4), remedy_(remedy) {}

void MemoryBudget::take(std::size_t bytes) {
  // No overflow: the sum is within the limit, and so is the request.
  std::size_t taken = taken_;
  do {
    if (bytes > limit_ || taken > limit_ - bytes)
      throw MemoryError(
          fmt::format("{}: the file requires more than {} of memory, the limit", file_.string(), bytesText(limit_)),
          remedy_);
  } while (!taken_.compare_exchange_weak(taken, taken + bytes));
}

}  // namespace quintet
