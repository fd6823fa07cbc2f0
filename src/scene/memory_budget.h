// SPDX-License-Identifier: Apache-2.0
// Sums up the memory that a scene file requests, before it is allocated. A few bytes of JSON can refer to the same
// large data a million times; without the budget the system would kill the process instead of reporting an error.
#ifndef QUINTET_SCENE_MEMORY_BUDGET_H
#define QUINTET_SCENE_MEMORY_BUDGET_H

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "base/error.h"

namespace quintet::scene {

class MemoryBudget {
 public:
  // `limit` in bytes; 0 means 80 % of the machine's memory.
  explicit MemoryBudget(const std::filesystem::path& file, std::size_t limit = 0);
  // Thread-safe. Throws MemoryError when the sum exceeds the limit.
  void take(std::size_t bytes);

 private:
  const std::filesystem::path file_;
  std::size_t limit_;
  std::atomic<std::size_t> taken_{0};
};

// Returns load(). A failed allocation becomes a MemoryError that names the file.
template <class Load>
auto withMemoryErrors(const std::filesystem::path& file, const Load& load) {
  try {
    return load();
  } catch (const std::bad_alloc&) {
    throw MemoryError(file.string() + ": not enough memory for the scene");
  } catch (const std::length_error&) {
    throw MemoryError(file.string() + ": the scene is larger than the address space");
  }
}

}  // namespace quintet::scene
#endif
