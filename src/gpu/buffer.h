// SPDX-License-Identifier: Apache-2.0
// A buffer with its memory. A buffer can be destroyed at any time: its memory is freed after the work that is submitted
// so far has ended.
#ifndef QUINTET_GPU_BUFFER_H
#define QUINTET_GPU_BUFFER_H

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gpu/context.h"

namespace quintet::gpu {

enum class Memory {
  device,    // fastest for the device; filled by Buffer::upload or an Uploader
  upload,    // written by the host (mapped), read by the device
  readback,  // written by the device, read by the host (mapped, cached)
};

struct BufferOptions {
  VkDeviceSize size = 0;  // bytes; 0 is rounded up to 4
  Memory memory = Memory::device;
  // Storage, transfer source, transfer destination and device address are always added.
  VkBufferUsageFlags usage = 0;
  VkDeviceSize alignment = 0;  // of the address in bytes; at least what the usage requires
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

  // Blocking copies through a staging buffer or the mapping, for setup and tests.
  void upload(std::span<const std::byte> data, VkDeviceSize offset = 0);
  void download(std::span<std::byte> data, VkDeviceSize offset = 0) const;
  // Copies through `staging` (Memory::readback). Creating a staging buffer takes longer than reading a few megabytes.
  void download(std::span<std::byte> data, VkDeviceSize offset, const Buffer& staging) const;
  // Creates a staging buffer for downloads of `size` bytes. It can be smaller; download then copies in steps.
  static Buffer makeReadback(Context& context, VkDeviceSize size);

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

// Creates a device buffer that contains `data`; the copy is complete on return. Empty data gives a buffer of 4 bytes.
Buffer makeBuffer(Context& context, std::span<const std::byte> data, VkBufferUsageFlags usage, const std::string& name);
template <class T>
Buffer makeBufferOf(Context& context, const std::vector<T>& data, VkBufferUsageFlags usage, const std::string& name) {
  return makeBuffer(context, std::as_bytes(std::span<const T>(data)), usage, name);
}

}  // namespace quintet::gpu
#endif
