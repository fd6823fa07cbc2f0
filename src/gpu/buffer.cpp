// SPDX-License-Identifier: Apache-2.0
#include "gpu/buffer.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "gpu/barrier.h"
#include "gpu/error.h"
#include "gpu/mebibytes.h"
#include "gpu/vma.h"

namespace quintet::gpu {
namespace {

constexpr VkDeviceSize kStagingBytes = VkDeviceSize{8} << 20;  // of one step of a blocking copy

VkDeviceSize alignmentOf(const Context& context, const BufferOptions& options) {
  VkDeviceSize alignment = std::max<VkDeviceSize>(options.alignment, 16);
  if (options.usage & VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR)
    alignment = std::max<VkDeviceSize>(alignment, 256);
  if (options.usage & VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR)
    alignment = std::max<VkDeviceSize>(alignment, context.info().limits.baseAlignment);
  return alignment;
}

void validateSize(const Context& context, const BufferOptions& options) {
  const DeviceInfo& info = context.info();
  const double size = mebibytes(options.size);
  if (options.memory == Memory::device && options.size > info.memoryBytes)
    throw MemoryError(fmt::format("buffer '{}' of {:.1f} MiB is larger than the device's memory of {:.1f} MiB",
                                  options.name, size, mebibytes(info.memoryBytes)));
  if (options.size > info.maxBufferBytes)
    throw MemoryError(fmt::format("buffer '{}' of {:.1f} MiB is larger than the device's limit of {:.1f} MiB",
                                  options.name, size, mebibytes(info.maxBufferBytes)));
  context.allocator().checkFreeMemory(options.size, fmt::format("buffer '{}'", options.name));
}

VmaAllocationCreateInfo allocationInfo(Memory memory, bool ownBlock) {
  VmaAllocationCreateInfo info{};
  info.usage = memory == Memory::device ? VMA_MEMORY_USAGE_AUTO_PREFER_DEVICE : VMA_MEMORY_USAGE_AUTO_PREFER_HOST;
  if (memory == Memory::upload)
    info.flags = VMA_ALLOCATION_CREATE_MAPPED_BIT | VMA_ALLOCATION_CREATE_HOST_ACCESS_SEQUENTIAL_WRITE_BIT;
  if (memory == Memory::readback)
    info.flags = VMA_ALLOCATION_CREATE_MAPPED_BIT | VMA_ALLOCATION_CREATE_HOST_ACCESS_RANDOM_BIT;
  if (ownBlock) info.flags |= VMA_ALLOCATION_CREATE_DEDICATED_MEMORY_BIT;
  return info;
}

void copyAndWait(Context& context, VkBuffer source, VkBuffer destination, const VkBufferCopy& region) {
  context.wait(context.submitRaw(
      [&](VkCommandBuffer commands) { context.vk().vkCmdCopyBuffer(commands, source, destination, 1, &region); }));
}

}  // namespace

Buffer::Buffer(Context& context, const BufferOptions& options) : context_(&context) {
  validateSize(context, options);
  size_ = std::max<VkDeviceSize>(options.size, 4);
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = size_;
  info.usage = options.usage | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
               VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
  const VmaAllocationCreateInfo allocation = allocationInfo(options.memory, context.allocator().needsOwnBlock(size_));
  VmaAllocationInfo allocated{};
  const VkResult result =
      vmaCreateBufferWithAlignment(context.allocator().handle(), &info, &allocation, alignmentOf(context, options),
                                   &handle_, &allocation_, &allocated);
  check(result, fmt::format("allocate {:.1f} MiB for buffer", mebibytes(size_)), options.name);
  context.allocator().track(allocation_, options.purpose);
  mapped_ = static_cast<std::byte*>(allocated.pMappedData);
  VkBufferDeviceAddressInfo addressInfo{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO};
  addressInfo.buffer = handle_;
  address_ = context.vk().vkGetBufferDeviceAddress(context.device(), &addressInfo);
  context.setName(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(handle_), options.name);
}

Buffer::~Buffer() { release(); }

Buffer::Buffer(Buffer&& other) noexcept { *this = std::move(other); }

Buffer& Buffer::operator=(Buffer&& other) noexcept {
  if (this == &other) return *this;
  release();
  context_ = std::exchange(other.context_, nullptr);
  handle_ = std::exchange(other.handle_, VkBuffer{VK_NULL_HANDLE});
  allocation_ = std::exchange(other.allocation_, nullptr);
  address_ = std::exchange(other.address_, 0);
  size_ = std::exchange(other.size_, 0);
  mapped_ = std::exchange(other.mapped_, nullptr);
  return *this;
}

void Buffer::release() {
  if (!handle_) return;
  context_->retire([context = context_, handle = handle_, allocation = allocation_] {
    context->allocator().untrack(allocation);
    vmaDestroyBuffer(context->allocator().handle(), handle, allocation);
  });
  handle_ = VK_NULL_HANDLE;
}

void Buffer::upload(std::span<const std::byte> data, VkDeviceSize offset) {
  assert(handle_ && offset + data.size() <= size_);
  if (data.empty()) return;
  if (mapped_) {
    context_->wait(context_->submitted());
    std::memcpy(mapped_ + offset, data.data(), data.size());
    check(vmaFlushAllocation(context_->allocator().handle(), allocation_, offset, data.size()),
          "flush a mapped buffer");
    return;
  }
  Buffer staging(*context_, {.size = std::min<VkDeviceSize>(data.size(), kStagingBytes),
                             .memory = Memory::upload,
                             .name = "staging for an upload",
                             .purpose = Purpose::staging});
  for (std::size_t done = 0; done < data.size();) {
    const std::size_t step = std::min<std::size_t>(data.size() - done, staging.size());
    staging.upload(data.subspan(done, step));
    copyAndWait(*context_, staging.handle_, handle_, {0, offset + done, step});
    done += step;
  }
}

void Buffer::download(std::span<std::byte> data, VkDeviceSize offset) const {
  assert(handle_ && offset + data.size() <= size_);
  if (data.empty()) return;
  if (mapped_) {
    context_->wait(context_->submitRaw(
        [&](VkCommandBuffer commands) { recordBarrier(context_->vk(), commands, Stage::all, Stage::host); }));
    check(vmaInvalidateAllocation(context_->allocator().handle(), allocation_, offset, data.size()),
          "read a mapped buffer");
    std::memcpy(data.data(), mapped_ + offset, data.size());
    return;
  }
  download(data, offset, makeReadback(*context_, data.size()));
}

void Buffer::download(std::span<std::byte> data, VkDeviceSize offset, const Buffer& staging) const {
  assert(handle_ && offset + data.size() <= size_ && staging.mapped_);
  if (mapped_) return download(data, offset);
  for (std::size_t done = 0; done < data.size();) {
    const std::size_t step = std::min<std::size_t>(data.size() - done, staging.size());
    copyAndWait(*context_, handle_, staging.handle_, {offset + done, 0, step});
    staging.download(data.subspan(done, step));
    done += step;
  }
}

Buffer Buffer::makeReadback(Context& context, VkDeviceSize size) {
  return Buffer(context, {.size = std::min(size, kStagingBytes),
                          .memory = Memory::readback,
                          .name = "staging for a download",
                          .purpose = Purpose::staging});
}

Buffer makeBuffer(Context& context, std::span<const std::byte> data, VkBufferUsageFlags usage,
                  const std::string& name) {
  Buffer buffer(context, {.size = data.size(), .usage = usage, .name = name});
  buffer.upload(data);
  return buffer;
}

}  // namespace quintet::gpu
