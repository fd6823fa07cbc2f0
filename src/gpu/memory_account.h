// The account of a context's memory: what the driver gave, in blocks, and for what buffers and images hold it.
#ifndef QUINTET_GPU_MEMORY_ACCOUNT_H
#define QUINTET_GPU_MEMORY_ACCOUNT_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>

namespace quintet::gpu {

enum class Purpose {
  geometry,  // attributes, triangles, boxes, solids
  textures,
  accelerationStructures,  // with the maps of primitives
  scratch,                 // of their builds
  staging,                 // host memory on the way to or from the device
  film,
  tables,  // the rest: lights, materials, instances, shader binding tables
};
constexpr std::size_t kPurposeCount = 7;
const char* purposeName(Purpose purpose);  // "accelerationStructures"

// Bytes.
struct DeviceMemory {
  std::uint64_t now = 0;
  std::uint64_t peak = 0;                           // the most since the context was made
  std::array<std::uint64_t, kPurposeCount> held{};  // of now, by Purpose; the rest is room in blocks
  // Of the peak, by Purpose: as things stood when it was last reached. The rest is room in blocks.
  std::array<std::uint64_t, kPurposeCount> atPeak{};
  std::uint64_t unusedAtPeak() const;
};

// From any thread.
class MemoryAccount {
 public:
  void addBlock(std::uint64_t size);
  void removeBlock(std::uint64_t size);
  // A part of the blocks, which are counted by then.
  void add(Purpose purpose, std::uint64_t size);
  void remove(Purpose purpose, std::uint64_t size);
  std::size_t blockCount() const;
  DeviceMemory memory() const;

 private:
  mutable std::mutex mutex_;
  std::size_t blockCount_ = 0;
  DeviceMemory memory_;
};

}  // namespace quintet::gpu
#endif
