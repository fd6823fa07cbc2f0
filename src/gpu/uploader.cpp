// SPDX-License-Identifier: Apache-2.0
#include "gpu/uploader.h"

#include <algorithm>
#include <cassert>

#include "base/math.h"
#include "base/parallel.h"
#include "gpu/commands.h"
#include "gpu/error.h"

namespace quintet::gpu {
namespace {

// A half holds at least one row of the largest image in the widest format.
constexpr VkDeviceSize kMinHalfBytes = VkDeviceSize{1} << 20;
constexpr VkDeviceSize kCopyAlignment = 16;  // a multiple of every texel size

}  // namespace

template <class Write, class Add>
void Uploader::stage(VkDeviceSize bytes, VkDeviceSize pieceBytes, const Write& write, const Add& add) {
  for (VkDeviceSize done = 0; done < bytes;) {
    VkDeviceSize room = halfBytes_ - used_;
    if (room < std::min(pieceBytes, bytes - done)) {
      submit();
      room = halfBytes_;
    }
    const VkDeviceSize length = std::min({bytes - done, pieceBytes, room});
    const VkDeviceSize offset = half_ * halfBytes_ + used_;
    write(done, std::span(staging_.mapped() + offset, length));
    add(offset, done, length);
    used_ += alignUp(length, kCopyAlignment);
    done += length;
  }
}

bool Uploader::overlaps(VkBuffer destination, VkDeviceSize begin, VkDeviceSize end) const {
  // Most buffers are filled from front to back, which needs no search.
  const auto written = ends_.find(destination);
  if (written == ends_.end() || begin >= written->second) return false;
  return std::any_of(bufferCopies_.begin(), bufferCopies_.end(), [&](const BufferCopy& copy) {
    return copy.destination == destination && copy.region.dstOffset < end &&
           begin < copy.region.dstOffset + copy.region.size;
  });
}

void Uploader::submit() {
  if (bufferCopies_.empty() && imageCopies_.empty()) return;
  busyUntil_[half_] = context_.submit([this](Commands& commands) { record(commands); });
  bufferCopies_.clear();
  imageCopies_.clear();
  ends_.clear();
  half_ = 1 - half_;
  used_ = 0;
  context_.wait(busyUntil_[half_]);
}

void Uploader::record(Commands& commands) const {
  const VolkDeviceTable& vk = context_.vk();
  for (const BufferCopy& copy : bufferCopies_)
    vk.vkCmdCopyBuffer(commands.handle(), staging_.handle(), copy.destination, 1, &copy.region);
  for (const ImageCopy& copy : imageCopies_) {
    if (copy.first)
      commands.transition(*copy.destination, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vk.vkCmdCopyBufferToImage(commands.handle(), staging_.handle(), copy.destination->handle(),
                              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy.region);
    if (copy.last)
      commands.transition(*copy.destination, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                          VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  }
}

Uploader::Uploader(Context& context, VkDeviceSize stagingBytes)
    : context_(context),
      halfBytes_(alignUp(std::max(stagingBytes / 2, kMinHalfBytes), kCopyAlignment)),
      staging_(context,
               {.size = 2 * halfBytes_, .memory = Memory::upload, .name = "upload ring", .purpose = Purpose::staging}) {
}

Uploader::~Uploader() {
  // During stack unwinding the destinations may already be destroyed, so copies that are not submitted are discarded.
  if (std::uncaught_exceptions() > exceptions_) {
    bufferCopies_.clear();
    imageCopies_.clear();
  }
  // A destructor cannot throw.
  try {
    flush();
  } catch (const DeviceLostError&) {  // so does every later use of the device, which reports it
  } catch (const std::exception& error) {
    if (context_.log()) context_.log()(LogLevel::warning, error.what());
  }
}

void Uploader::upload(const Buffer& destination, std::span<const std::byte> data, VkDeviceSize offset) {
  assert(offset + data.size() <= destination.size());
  // Copies of one submission are not ordered.
  if (overlaps(destination.handle(), offset, offset + data.size())) submit();
  const auto copy = [&](VkDeviceSize position, std::span<std::byte> out) {
    parallelCopy(out.data(), data.subspan(position, out.size()));
  };
  stage(data.size(), halfBytes_, copy, [&](VkDeviceSize staged, VkDeviceSize position, VkDeviceSize length) {
    bufferCopies_.push_back({destination.handle(), {staged, offset + position, length}});
    VkDeviceSize& end = ends_[destination.handle()];
    end = std::max(end, offset + position + length);
  });
}

void Uploader::upload(const Image& destination, std::span<const std::byte> pixels) {
  assert(pixels.size() == destination.byteSize());
  const VkDeviceSize rowBytes = destination.byteSize() / destination.height();
  upload(destination, [&](std::uint32_t first, std::span<std::byte> rows) {
    parallelCopy(rows.data(), pixels.subspan(first * rowBytes, rows.size()));
  });
}

void Uploader::upload(const Image& destination, const WriteRows& write) {
  const VkDeviceSize bytes = destination.byteSize(), rowBytes = bytes / destination.height();
  const VkDeviceSize rows = std::min<VkDeviceSize>(halfBytes_ / rowBytes, destination.height());
  const auto writeRows = [&](VkDeviceSize position, std::span<std::byte> out) {
    write(static_cast<std::uint32_t>(position / rowBytes), out);
  };
  stage(bytes, rows * rowBytes, writeRows, [&](VkDeviceSize staged, VkDeviceSize position, VkDeviceSize length) {
    VkBufferImageCopy region{};
    region.bufferOffset = staged;
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageOffset = {0, static_cast<std::int32_t>(position / rowBytes), 0};
    region.imageExtent = {destination.width(), static_cast<std::uint32_t>(length / rowBytes), 1};
    imageCopies_.push_back({&destination, region, position == 0, position + length == bytes});
  });
}

void Uploader::flush() {
  submit();
  context_.wait(std::max(busyUntil_[0], busyUntil_[1]));
}

}  // namespace quintet::gpu
