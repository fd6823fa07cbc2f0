#include "gpu/memory_account.h"

#include <algorithm>
#include <numeric>

namespace quintet::gpu {

const char* purposeName(Purpose purpose) {
  constexpr std::array<const char*, kPurposeCount> kNames{
      "geometry", "textures", "accelerationStructures", "scratch", "staging", "film", "tables"};
  return kNames[static_cast<std::size_t>(purpose)];
}

std::uint64_t DeviceMemory::unusedAtPeak() const {
  const std::uint64_t used = std::accumulate(atPeak.begin(), atPeak.end(), std::uint64_t{0});
  return peak - std::min(used, peak);
}

void MemoryAccount::addBlock(std::uint64_t size) {
  const std::lock_guard lock(mutex_);
  ++blockCount_;
  memory_.now += size;
  memory_.peak = std::max(memory_.peak, memory_.now);
}

void MemoryAccount::removeBlock(std::uint64_t size) {
  const std::lock_guard lock(mutex_);
  --blockCount_;
  memory_.now -= size;
}

void MemoryAccount::add(Purpose purpose, std::uint64_t size) {
  const std::lock_guard lock(mutex_);
  memory_.held[static_cast<std::size_t>(purpose)] += size;
  if (memory_.now == memory_.peak) memory_.atPeak = memory_.held;
}

void MemoryAccount::remove(Purpose purpose, std::uint64_t size) {
  const std::lock_guard lock(mutex_);
  memory_.held[static_cast<std::size_t>(purpose)] -= size;
}

std::size_t MemoryAccount::blockCount() const {
  const std::lock_guard lock(mutex_);
  return blockCount_;
}

DeviceMemory MemoryAccount::memory() const {
  const std::lock_guard lock(mutex_);
  return memory_;
}

}  // namespace quintet::gpu
