// Uploader: two halves of one staging buffer; while the device copies from one, the host fills the other.
#include <algorithm>
#include <array>
#include <cassert>
#include <exception>
#include <unordered_map>
#include <vector>

#include "base/parallel.h"
#include "gpu/buffer.h"
#include "gpu/commands.h"
#include "gpu/image.h"

namespace quintet::gpu {

namespace {

// One row of the largest image in the widest format fits into a half, whatever the caller asks for.
constexpr VkDeviceSize kMinHalfBytes = VkDeviceSize{1} << 20;
constexpr VkDeviceSize kCopyAlignment = 16;  // a multiple of every texel size

VkDeviceSize alignUp(VkDeviceSize value) { return (value + kCopyAlignment - 1) / kCopyAlignment * kCopyAlignment; }

}  // namespace

struct Uploader::Impl {
  struct BufferCopy {
    VkBuffer destination;
    VkBufferCopy region;
  };
  struct ImageCopy {
    const Image* destination;
    VkBufferImageCopy region;
    bool first;  // the image's layout is still undefined
    bool last;   // then shaders may read it
  };

  Impl(Context& owner, VkDeviceSize stagingBytes)
      : context(owner),
        halfBytes(alignUp(std::max(stagingBytes / 2, kMinHalfBytes))),
        staging(owner,
                {.size = 2 * halfBytes, .memory = Memory::upload, .name = "upload ring", .purpose = Purpose::staging}) {
  }

  // Has `bytes` bytes written into the ring, in pieces of at most `pieceBytes`; calls write(position, where) and then
  // add(staging offset, position, length) for each.
  template <class Write, class Add>
  void stage(VkDeviceSize bytes, VkDeviceSize pieceBytes, const Write& write, const Add& add);
  // With a copy that waits in the current half.
  bool overlaps(VkBuffer destination, VkDeviceSize begin, VkDeviceSize end) const;
  void submit();
  void record(Commands& commands) const;

  Context& context;
  VkDeviceSize halfBytes;
  Buffer staging;
  VkDeviceSize used = 0;  // bytes of the current half
  std::size_t half = 0;
  std::array<std::uint64_t, 2> busyUntil{};  // timeline value that frees each half
  std::vector<BufferCopy> bufferCopies;
  std::vector<ImageCopy> imageCopies;
  std::unordered_map<VkBuffer, VkDeviceSize> ends;  // of what bufferCopies write, by destination
  const int exceptions = std::uncaught_exceptions();
};

template <class Write, class Add>
void Uploader::Impl::stage(VkDeviceSize bytes, VkDeviceSize pieceBytes, const Write& write, const Add& add) {
  for (VkDeviceSize done = 0; done < bytes;) {
    VkDeviceSize room = halfBytes - used;
    if (room < std::min(pieceBytes, bytes - done)) {
      submit();
      room = halfBytes;
    }
    const VkDeviceSize length = std::min({bytes - done, pieceBytes, room});
    const VkDeviceSize offset = half * halfBytes + used;
    write(done, std::span(staging.mapped() + offset, length));
    add(offset, done, length);
    used += alignUp(length);
    done += length;
  }
}

bool Uploader::Impl::overlaps(VkBuffer destination, VkDeviceSize begin, VkDeviceSize end) const {
  // Most buffers are filled from front to back: then there is nothing to search.
  const auto written = ends.find(destination);
  if (written == ends.end() || begin >= written->second) return false;
  return std::any_of(bufferCopies.begin(), bufferCopies.end(), [&](const BufferCopy& copy) {
    return copy.destination == destination && copy.region.dstOffset < end &&
           begin < copy.region.dstOffset + copy.region.size;
  });
}

void Uploader::Impl::submit() {
  if (bufferCopies.empty() && imageCopies.empty()) return;
  busyUntil[half] = context.submit([this](Commands& commands) { record(commands); });
  bufferCopies.clear();
  imageCopies.clear();
  ends.clear();
  half = 1 - half;
  used = 0;
  context.wait(busyUntil[half]);
}

void Uploader::Impl::record(Commands& commands) const {
  const VolkDeviceTable& vk = context.vk();
  for (const BufferCopy& copy : bufferCopies)
    vk.vkCmdCopyBuffer(commands.handle(), staging.handle(), copy.destination, 1, &copy.region);
  for (const ImageCopy& copy : imageCopies) {
    if (copy.first)
      commands.transition(*copy.destination, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vk.vkCmdCopyBufferToImage(commands.handle(), staging.handle(), copy.destination->handle(),
                              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy.region);
    if (copy.last)
      commands.transition(*copy.destination, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                          VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  }
}

Uploader::Uploader(Context& context, VkDeviceSize stagingBytes)
    : impl_(std::make_unique<Impl>(context, stagingBytes)) {}

Uploader::~Uploader() {
  // An exception may have destroyed destinations already: nobody waits for what is not submitted yet.
  if (std::uncaught_exceptions() > impl_->exceptions) {
    impl_->bufferCopies.clear();
    impl_->imageCopies.clear();
  }
  try {
    flush();
  } catch (const std::exception& error) {
    // A destructor cannot tell; whoever uses the device next is told the same.
    if (impl_->context.log()) impl_->context.log()(LogLevel::warning, error.what());
  }
}

void Uploader::upload(const Buffer& destination, std::span<const std::byte> data, VkDeviceSize offset) {
  assert(offset + data.size() <= destination.size());
  // Copies of one submission have no order among themselves.
  if (impl_->overlaps(destination.handle(), offset, offset + data.size())) impl_->submit();
  const auto copy = [&](VkDeviceSize position, std::span<std::byte> out) {
    parallelCopy(out.data(), data.subspan(position, out.size()));
  };
  impl_->stage(data.size(), impl_->halfBytes, copy,
               [&](VkDeviceSize staged, VkDeviceSize position, VkDeviceSize length) {
                 impl_->bufferCopies.push_back({destination.handle(), {staged, offset + position, length}});
                 VkDeviceSize& end = impl_->ends[destination.handle()];
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
  const VkDeviceSize rows = std::min<VkDeviceSize>(impl_->halfBytes / rowBytes, destination.height());
  const auto writeRows = [&](VkDeviceSize position, std::span<std::byte> out) {
    write(static_cast<std::uint32_t>(position / rowBytes), out);
  };
  impl_->stage(bytes, rows * rowBytes, writeRows, [&](VkDeviceSize staged, VkDeviceSize position, VkDeviceSize length) {
    VkBufferImageCopy region{};
    region.bufferOffset = staged;
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageOffset = {0, static_cast<std::int32_t>(position / rowBytes), 0};
    region.imageExtent = {destination.width(), static_cast<std::uint32_t>(length / rowBytes), 1};
    impl_->imageCopies.push_back({&destination, region, position == 0, position + length == bytes});
  });
}

void Uploader::flush() {
  impl_->submit();
  impl_->context.wait(std::max(impl_->busyUntil[0], impl_->busyUntil[1]));
}

}  // namespace quintet::gpu
