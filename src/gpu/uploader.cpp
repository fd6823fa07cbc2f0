// Uploader: two halves of one staging buffer; while the device copies from one, the host fills the other.
#include <algorithm>
#include <array>
#include <cassert>
#include <exception>
#include <unordered_map>
#include <vector>

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
        staging(owner, {.size = 2 * halfBytes, .memory = Memory::upload, .name = "upload ring", .purpose = Purpose::staging}) {}

  // Copies `data` into the ring, in pieces of at most `pieceBytes`; calls add(staging offset, position
  // in data, length) for each.
  template <class Add>
  void stage(std::span<const std::byte> data, VkDeviceSize pieceBytes, const Add& add);
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

template <class Add>
void Uploader::Impl::stage(std::span<const std::byte> data, VkDeviceSize pieceBytes, const Add& add) {
  for (std::size_t done = 0; done < data.size();) {
    VkDeviceSize room = halfBytes - used;
    if (room < std::min<VkDeviceSize>(pieceBytes, data.size() - done)) {
      submit();
      room = halfBytes;
    }
    const std::size_t length = std::min<std::size_t>({data.size() - done, pieceBytes, room});
    const VkDeviceSize offset = half * halfBytes + used;
    std::memcpy(staging.mapped() + offset, data.data() + done, length);
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
  impl_->stage(data, impl_->halfBytes, [&](VkDeviceSize staged, VkDeviceSize position, VkDeviceSize length) {
    impl_->bufferCopies.push_back({destination.handle(), {staged, offset + position, length}});
    VkDeviceSize& end = impl_->ends[destination.handle()];
    end = std::max(end, offset + position + length);
  });
}

void Uploader::upload(const Image& destination, std::span<const std::byte> pixels) {
  assert(pixels.size() == destination.byteSize());
  const VkDeviceSize rowBytes = destination.byteSize() / destination.height();
  const VkDeviceSize rows = std::min<VkDeviceSize>(impl_->halfBytes / rowBytes, destination.height());
  impl_->stage(pixels, rows * rowBytes, [&](VkDeviceSize staged, VkDeviceSize position, VkDeviceSize length) {
    VkBufferImageCopy region{};
    region.bufferOffset = staged;
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageOffset = {0, static_cast<std::int32_t>(position / rowBytes), 0};
    region.imageExtent = {destination.width(), static_cast<std::uint32_t>(length / rowBytes), 1};
    impl_->imageCopies.push_back({&destination, region, position == 0, position + length == pixels.size()});
  });
}

void Uploader::flush() {
  impl_->submit();
  impl_->context.wait(std::max(impl_->busyUntil[0], impl_->busyUntil[1]));
}

}  // namespace quintet::gpu
