// Adds up what a file asks for, before it is allocated: a few bytes of JSON can refer to the same large
// data a million times, and the system would kill the process instead of reporting an error.
#ifndef QUINTET_SCENE_MEMORY_BUDGET_H
#define QUINTET_SCENE_MEMORY_BUDGET_H

#include <atomic>
#include <cstddef>
#include <filesystem>

namespace quintet::scene {

class MemoryBudget {
 public:
  // `limit` in bytes; 0: the machine's memory.
  explicit MemoryBudget(const std::filesystem::path& file, std::size_t limit = 0);
  // Thread-safe. Throws MemoryError when the sum exceeds the limit.
  void take(std::size_t bytes);

 private:
  const std::filesystem::path file_;
  std::size_t limit_;
  std::atomic<std::size_t> taken_{0};
};

}  // namespace quintet::scene
#endif
