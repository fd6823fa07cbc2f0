// SPDX-License-Identifier: Apache-2.0
#include "scene/memory_budget.h"

#include <fmt/format.h>
#include <unistd.h>

#include "base/text.h"

namespace quintet::scene {
namespace {

std::size_t machineMemory() {
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGE_SIZE);
  constexpr std::size_t kUnknown = std::size_t{1} << 46;
  return pages > 0 && size > 0 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(size) : kUnknown;
}

}  // namespace

MemoryBudget::MemoryBudget(const std::filesystem::path& file, std::size_t limit)
    : file_(file), limit_(limit ? limit : machineMemory() / 5 * 4) {}

void MemoryBudget::take(std::size_t bytes) {
  // No overflow: each request is far below 2^60, and the first one above the limit throws.
  if (bytes > limit_ || taken_.fetch_add(bytes) + bytes > limit_)
    throw MemoryError(
        fmt::format("{}: the scene requires more than {} of memory, the limit", file_.string(), bytesText(limit_)),
        Remedy::raiseMemoryLimit);
}

}  // namespace quintet::scene
