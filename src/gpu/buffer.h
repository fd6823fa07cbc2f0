// A buffer with its memory. Destroying one is safe at any time: its memory is freed when the work
// submitted so far has ended.
#ifndef QUINTET_GPU_BUFFER_H
#define QUINTET_GPU_BUFFER_H

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/context.h"

VK_DEFINE_HANDLE(VmaAllocation)

namespace quintet::gpu {

enum class Memory {
  device,    // fastest for the device; fill with Buffer::upload or an Uploader
  upload,    // host writes (mapped), device reads
  readback,  // device writes, host reads (mapped, cached)
};

struct BufferOptions {
  VkDeviceSize size = 0;  // bytes; 0 is rounded up to 4
  Memory memory = Memory::device;
  // Storage, transfer source and destination and device address are always included.
  VkBufferUsageFlags usage = 0;
  VkDeviceSize alignment = 0;  // bytes of the address; 0: what the usage needs
  std::string name;
  Purpose purpose = Purpose::tables;
};

class Buffer {
 public:
  Buffer() = default;  // empty: handle() is null
  Buffer(Context& context, const BufferOptions& options);
  ~Buffer();
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;

  VkBuffer handle() const { return handle_; }
  VkDeviceAddress address() const { return address_; }
  VkDeviceSize size() const { return size_; }
  std::byte* mapped() const { return mapped_; }  // null for Memory::device
  explicit operator bool() const { return handle_ != VK_NULL_HANDLE; }

  // Blocking copies through a staging buffer (or the mapping): for set-up and tests.
  void upload(std::span<const std::byte> data, VkDeviceSize offset = 0);
  void download(std::span<std::byte> data, VkDeviceSize offset = 0) const;
  // Through the caller's staging (Memory::readback): making one takes longer than reading some megabytes.
  void download(std::span<std::byte> data, VkDeviceSize offset, const Buffer& staging) const;
  static Buffer makeReadback(Context& context, VkDeviceSize size);  // of a staging's usual size at most

  template <class T>
  void uploadAs(std::span<const T> data) {
    upload(std::as_bytes(data));
  }
  template <class T>
  std::vector<T> downloadAs(std::size_t count) const {
    std::vector<T> result(count);
    download(std::as_writable_bytes(std::span<T>(result)));
    return result;
  }

 private:
  void release();
  Context* context_ = nullptr;
  VkBuffer handle_ = VK_NULL_HANDLE;
  VmaAllocation allocation_ = VK_NULL_HANDLE;
  VkDeviceAddress address_ = 0;
  VkDeviceSize size_ = 0;
  std::byte* mapped_ = nullptr;
};

// A device buffer that holds `data` (copied before this returns). Empty data gives a 4-byte buffer.
Buffer makeBuffer(Context& context, std::span<const std::byte> data, VkBufferUsageFlags usage, const std::string& name);
template <class T>
Buffer makeBufferOf(Context& context, const std::vector<T>& data, VkBufferUsageFlags usage, const std::string& name) {
  return makeBuffer(context, std::as_bytes(std::span<const T>(data)), usage, name);
}

// Many copies in few submissions: fills device buffers and images through a staging ring of fixed size.
// `data` is read before upload returns; a destination must live until the flush.
class Uploader {
 public:
  explicit Uploader(Context& context, VkDeviceSize stagingBytes = VkDeviceSize{16} << 20);
  ~Uploader();  // flushes
  Uploader(const Uploader&) = delete;
  Uploader& operator=(const Uploader&) = delete;
  void upload(const Buffer& destination, std::span<const std::byte> data, VkDeviceSize offset = 0);
  // All pixels of the image, row after row, tightly packed; leaves it in SHADER_READ_ONLY_OPTIMAL.
  void upload(const class Image& destination, std::span<const std::byte> pixels);
  // The same, made where they are copied from: write(first, rows) fills `rows`, whole rows of pixels from `first` on.
  using WriteRows = std::function<void(std::uint32_t first, std::span<std::byte> rows)>;
  void upload(const class Image& destination, const WriteRows& write);
  void flush();  // submits and waits

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace quintet::gpu
#endif
