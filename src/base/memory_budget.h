// SPDX-License-Identifier: Apache-2.0
// Sums up the memory that a file requests, before it is allocated. A header of a few bytes can state any size, and a few
// bytes of JSON can refer to the same large data a million times; without the budget the system would kill the process
// instead of reporting an error.
#ifndef QUINTET_BASE_MEMORY_BUDGET_H
#define QUINTET_BASE_MEMORY_BUDGET_H

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <new>
#include <stdexcept>

#include "base/error.h"

namespace quintet {

class MemoryBudget {
 public:
  // Of `file` and of the files that it names. `limit` in bytes of host memory; 0 means 80 % of the machine's memory.
  // `remedy`: that of the MemoryErrors; none if the caller cannot change the limit.
  explicit MemoryBudget(const std::filesystem::path& file, std::size_t limit = 0,
                        Remedy remedy = Remedy::raiseMemoryLimit);
  MemoryBudget(const MemoryBudget&) = delete;
  MemoryBudget& operator=(const MemoryBudget&) = delete;

  // Thread-safe. Throws MemoryError when the sum exceeds the limit.
  void take(std::size_t bytes);
  // Of memory that was taken and is freed.
  void giveBack(std::size_t bytes) { taken_ -= bytes; }

 private:
  const std::filesystem::path file_;
  const std::size_t limit_;
  const Remedy remedy_;
  std::atomic<std::size_t> taken_{0};
};

// Memory that is only used for a while: taken by the constructor, given back by the destructor.
class TemporaryMemory {
 public:
  TemporaryMemory(MemoryBudget& budget, std::size_t bytes) : budget_(budget), bytes_(bytes) { budget_.take(bytes_); }
  ~TemporaryMemory() { budget_.giveBack(bytes_); }
  TemporaryMemory(const TemporaryMemory&) = delete;
  TemporaryMemory& operator=(const TemporaryMemory&) = delete;

 private:
  MemoryBudget& budget_;
  const std::size_t bytes_;
};

// Returns load(). A failed allocation becomes a MemoryError that names the file.
template <class Load>
auto withMemoryErrors(const std::filesystem::path& file, const Load& load) {
  try {
    return load();
  } catch (const std::bad_alloc&) {
    throw MemoryError(file.string() + ": not enough memory for the file");
  } catch (const std::length_error&) {
    throw MemoryError(file.string() + ": the file requires more memory than the address space has");
  }
}

}  // namespace quintet
#endif
