// SPDX-License-Identifier: Apache-2.0
// Fills device buffers and images through a staging ring of fixed size with few submissions.
#ifndef QUINTET_GPU_UPLOADER_H
#define QUINTET_GPU_UPLOADER_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/image.h"

namespace quintet::gpu {

class Commands;

// The ring has two halves: the device copies from one while the host fills the other. upload reads its data before it
// returns. Destinations must exist until the flush.
class Uploader {
 public:
  explicit Uploader(Context& context, VkDeviceSize stagingBytes = VkDeviceSize{16} << 20);
  ~Uploader();  // flushes
  Uploader(const Uploader&) = delete;
  Uploader& operator=(const Uploader&) = delete;

  VkDeviceSize stagingBytes() const { return staging_.size(); }
  void upload(const Buffer& destination, std::span<const std::byte> data, VkDeviceSize offset = 0);
  // Uploads all pixels, in tightly packed rows, and leaves the image in the layout SHADER_READ_ONLY_OPTIMAL.
  void upload(const Image& destination, std::span<const std::byte> pixels);
  // Uploads pixels that write(first, rows) creates: it fills `rows`, whole rows of pixels from row `first` on.
  using WriteRows = std::function<void(std::uint32_t first, std::span<std::byte> rows)>;
  void upload(const Image& destination, const WriteRows& write);
  void flush();  // submits and waits

 private:
  struct BufferCopy {
    VkBuffer destination;
    VkBufferCopy region;
  };
  struct ImageCopy {
    const Image* destination;
    VkBufferImageCopy region;
    bool first;  // the layout of the image is undefined
    bool last;   // shaders can read the image afterwards
  };

  // Writes `bytes` bytes into the ring in pieces of at most `pieceBytes`. Calls write(position, span) and then
  // add(staging offset, position, length) for each piece.
  template <class Write, class Add>
  void stage(VkDeviceSize bytes, VkDeviceSize pieceBytes, const Write& write, const Add& add);
  // Returns whether a copy in the current half writes to this range.
  bool overlaps(VkBuffer destination, VkDeviceSize begin, VkDeviceSize end) const;
  void submit();
  void record(Commands& commands) const;

  Context& context_;
  VkDeviceSize halfBytes_;
  Buffer staging_;
  VkDeviceSize used_ = 0;  // bytes of the current half
  std::size_t half_ = 0;
  std::array<std::uint64_t, 2> busyUntil_{};  // timeline value after which each half is free
  std::vector<BufferCopy> bufferCopies_;
  std::vector<ImageCopy> imageCopies_;
  std::unordered_map<VkBuffer, VkDeviceSize> ends_;  // end of the range that bufferCopies_ write, by destination
  const int exceptions_ = std::uncaught_exceptions();
};

}  // namespace quintet::gpu
#endif
