// SPDX-License-Identifier: Apache-2.0
#include "io/exr/read.h"

#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfPartType.h>
#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace quintet::io {
namespace {

// ---- Header scan; layout: https://openexr.com/en/latest/OpenEXRFileLayout.html

constexpr std::uint32_t kMultiPart = 0x1000;
constexpr std::uint64_t kMaxTileArea = std::uint64_t{1} << 26;
constexpr std::size_t kMaxNameBytes = 255;
constexpr std::size_t kChunkPointer = 8;   // bytes per entry of the chunk table
constexpr std::size_t kChannelBytes = 16;  // of a channel after its name

// Attribute types with values of a fixed size in bytes. OpenEXR ignores the stated size of these; with a wrong one it would
// take the values for the names and sizes of other attributes.
struct TypeSize {
  std::string_view type;
  std::uint32_t bytes;
};
constexpr TypeSize kFixedSizes[] = {
    {"box2i", 16},
    {"box2f", 16},
    {"chromaticities", 32},
    {"compression", 1},
    {"deepImageState", 1},
    {"double", 8},
    {"envmap", 1},
    {"float", 4},
    {"int", 4},
    {"keycode", 28},
    {"lineOrder", 1},
    {"m33f", 36},
    {"m33d", 72},
    {"m44f", 64},
    {"m44d", 128},
    {"rational", 8},
    {"tiledesc", 9},
    {"timecode", 8},
    {"v2i", 8},
    {"v2f", 8},
    {"v2d", 16},
    {"v3i", 12},
    {"v3f", 12},
    {"v3d", 24},
};

struct Window {
  std::uint64_t width = 0;
  std::uint64_t height = 0;
};

class HeaderScan {
 public:
  explicit HeaderScan(const Source& source) : source_(source) {}

  void run() {
    const bool multiPart = (read32(4) & kMultiPart) != 0;
    at_ = 8;
    do {
      scanPart();
    } while (multiPart && !atTerminator());
  }

 private:
  [[noreturn]] void failEarly() const { source_.fail(source_.size(), "the OpenEXR header ends early"); }

  std::uint32_t read32(std::size_t offset) const {
    if (offset > source_.size() || source_.size() - offset < 4) failEarly();
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(source_[offset + i]) << (8 * i);
    return value;
  }

  // Skips an empty name, which ends a header or the list of headers.
  bool atTerminator() {
    if (at_ >= source_.size()) failEarly();
    if (source_[at_] != 0) return false;
    ++at_;
    return true;
  }

  std::string_view readName() {
    const std::size_t begin = at_;
    while (true) {
      if (at_ >= source_.size()) failEarly();
      if (source_[at_++] == 0) break;
      if (at_ - begin > kMaxNameBytes) source_.fail(begin, "broken OpenEXR: a name has no end");
    }
    return {reinterpret_cast<const char*>(source_.data()) + begin, at_ - 1 - begin};
  }

  void scanPart() {
    Window data;
    Window tile;
    while (!atTerminator()) {
      const std::string_view name = readName(), type = readName();
      const std::uint32_t size = read32(at_);
      at_ += 4;
      if (size > source_.size() - at_)
        source_.fail(at_ - 4, fmt::format("broken OpenEXR: the attribute '{}' is larger than the file", name));
      if (!hasSize(type, size))
        source_.fail(at_ - 4, fmt::format("broken OpenEXR: the attribute '{}' has a wrong size", name));
      if (name == "displayWindow" && size == 16) readWindow(name);
      if (name == "dataWindow" && size == 16) data = readWindow(name);
      if (name == "tiles" && size == 9) tile = {read32(at_), read32(at_ + 4)};
      if (name == "chunkCount" && size == 4) checkChunks(read32(at_));
      at_ += size;
    }
    if (tile.width * tile.height == 0) return;
    if (tile.width > kMaxImageSide || tile.height > kMaxImageSide || tile.width * tile.height > kMaxTileArea)
      source_.fail(fmt::format("the OpenEXR tiles are too large: {} x {} pixels", tile.width, tile.height));
    checkChunks(((data.width + tile.width - 1) / tile.width) * ((data.height + tile.height - 1) / tile.height));
  }

  // Whether the value of an attribute fills `size` bytes.
  bool hasSize(std::string_view type, std::uint32_t size) const {
    const auto fixed = std::ranges::find(kFixedSizes, type, &TypeSize::type);
    if (fixed != std::end(kFixedSizes)) return size == fixed->bytes;
    if (type == "chlist") return size > 0 && channelListBytes(size) == size;
    if (type == "stringvector") return stringsFill(size);
    if (type == "preview")
      return size >= 8 && size % 4 == 0 && std::uint64_t{read32(at_)} * read32(at_ + 4) == (size - 8) / 4;
    return true;
  }

  // Bytes of a list of channels up to the empty name at its end; 0 if it does not end within `size` bytes.
  std::size_t channelListBytes(std::size_t size) const {
    for (std::size_t used = 0; used < size;) {
      if (source_[at_ + used] == 0) return used + 1;
      while (used < size && source_[at_ + used] != 0) ++used;
      used += 1 + kChannelBytes;
    }
    return 0;
  }

  // Whether strings with a length before each fill `size` bytes.
  bool stringsFill(std::size_t size) const {
    std::size_t used = 0;
    while (size - used >= 4) {
      const std::size_t length = read32(at_ + used);
      if (length > size - used - 4) return false;
      used += 4 + length;
    }
    return used == size;
  }

  void checkChunks(std::uint64_t count) const {
    if (count > source_.size() / kChunkPointer) source_.fail(source_.size(), "OpenEXR data ends early");
  }

  Window readWindow(std::string_view name) const {
    const auto coordinate = [&](std::size_t i) {
      return static_cast<std::int64_t>(static_cast<std::int32_t>(read32(at_ + 4 * i)));
    };
    const std::int64_t width = coordinate(2) - coordinate(0) + 1;
    const std::int64_t height = coordinate(3) - coordinate(1) + 1;
    if (width < 1 || height < 1) source_.fail(at_, fmt::format("broken OpenEXR: the {} is empty", name));
    // OpenEXR adds and subtracts coordinates as int, hence the limit of 2^30.
    for (std::size_t i = 0; i < 4; ++i)
      if (coordinate(i) < -(1 << 30) || coordinate(i) > 1 << 30)
        source_.fail(at_, fmt::format("broken OpenEXR: the {} is out of range", name));
    // Only pixels of the data window are stored; the decoder limits the display window (checkChannels).
    if (name == "dataWindow")
      source_.checkSize(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), 1);
    return {static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height)};
  }

  const Source& source_;
  std::size_t at_ = 0;
};

// ---- Channels

// Upper bound of the compression ratio: a constant image with DWAB reaches about 100 000.
constexpr std::uint64_t kBestRatio = std::uint64_t{1} << 20;

// Returns the part of `plane` (data window) inside the display window, with 0 elsewhere.
template <class Sample>
std::vector<Sample> crop(const std::vector<Sample>& plane, const Imath::Box2i& data, const Imath::Box2i& display) {
  const std::size_t from = extent(data.min.x, data.max.x);
  const std::size_t to = extent(display.min.x, display.max.x);
  std::vector<Sample> result(to * extent(display.min.y, display.max.y));
  const int left = std::max(data.min.x, display.min.x);
  const int right = std::min(data.max.x, display.max.x);
  if (left > right) return result;
  for (int y = std::max(data.min.y, display.min.y); y <= std::min(data.max.y, display.max.y); ++y) {
    const Sample* row = plane.data() + static_cast<std::size_t>(y - data.min.y) * from;
    std::copy(row + (left - data.min.x), row + (right - data.min.x) + 1,
              result.data() + static_cast<std::size_t>(y - display.min.y) * to +
                  static_cast<std::size_t>(left - display.min.x));
  }
  return result;
}

// Allocates a channel's samples and describes them to OpenEXR.
Imf::Slice makeSlice(ExrChannel& channel, std::size_t pixels, const Imath::Box2i& data) {
  if (channel.type == ExrType::u32) {
    channel.integers.resize(pixels);
    return Imf::Slice::Make(Imf::UINT, channel.integers.data(), data);
  }
  channel.samples.resize(pixels);
  return Imf::Slice::Make(Imf::FLOAT, channel.samples.data(), data);
}

}  // namespace

bool isExr(const Source& source) { return source.has(0, "\x76\x2f\x31\x01"); }

void checkExrHeader(const Source& source) { HeaderScan(source).run(); }

void failBroken(const Source& source, bool ended, const std::exception& error) {
  if (ended) source.fail(source.size(), "OpenEXR data ends early");
  const std::string_view text(error.what());
  source.fail(fmt::format("broken OpenEXR: {}", text.substr(0, text.find('\n'))));
}

std::uint32_t extent(int min, int max) { return static_cast<std::uint32_t>(std::int64_t{max} - min + 1); }

ExrType storedType(Imf::PixelType type) {
  return type == Imf::HALF ? ExrType::half : type == Imf::UINT ? ExrType::u32 : ExrType::f32;
}

bool isFlat(const Imf::Header& header) { return !header.hasType() || Imf::isImage(header.type()); }

std::vector<std::string> channelNames(const Imf::Header& header) {
  std::vector<std::string> names;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) names.emplace_back(it.name());
  return names;
}

std::string fullChannelName(const Imf::Header& header, bool firstPart, const std::string& channel) {
  const bool bare = channel.find('.') == std::string::npos;
  return !firstPart && bare && header.hasName() ? header.name() + "." + channel : channel;
}

void checkChannels(const Source& source, const Imf::Header& header, const std::vector<std::string>& names,
                   std::uint64_t maxBytes) {
  for (const std::string& name : names)
    if (const Imf::Channel& channel = header.channels()[name]; channel.xSampling != 1 || channel.ySampling != 1)
      source.fail(fmt::format("OpenEXR with the subsampled channel '{}' is not supported", name));
  const std::uint64_t pixelBytes = names.size() * sizeof(float);
  for (const Imath::Box2i& box : {header.dataWindow(), header.displayWindow()}) {
    const std::uint64_t width = extent(box.min.x, box.max.x);
    const std::uint64_t height = extent(box.min.y, box.max.y);
    source.checkSize(width, height, maxBytes == kMaxImageBytes ? pixelBytes : 1);
    if (width * height * pixelBytes > maxBytes) source.fail("the OpenEXR channels are too large together");
  }
  const Imath::Box2i& data = header.dataWindow();
  source.checkExpansion(std::uint64_t{extent(data.min.x, data.max.x)} * extent(data.min.y, data.max.y) * pixelBytes,
                        kBestRatio);
}

std::size_t channelBytes(const Imf::Header& header, std::size_t count) {
  const auto pixels = [](const Imath::Box2i& box) {
    return std::size_t{extent(box.min.x, box.max.x)} * extent(box.min.y, box.max.y);
  };
  const Imath::Box2i &data = header.dataWindow(), &display = header.displayWindow();
  return count * sizeof(float) * (pixels(data) + (data == display ? 0 : pixels(display)));
}

std::vector<ExrChannel> readChannels(const Source& source, Imf::MultiPartInputFile& file, int index,
                                     const std::vector<std::string>& names) {
  const Imf::Header& header = file.header(index);
  const Imath::Box2i& data = header.dataWindow();
  const Imath::Box2i& display = header.displayWindow();
  const std::size_t pixels = std::size_t{extent(data.min.x, data.max.x)} * extent(data.min.y, data.max.y);

  std::vector<ExrChannel> channels;
  for (const std::string& name : names) channels.push_back({name, storedType(header.channels()[name].type), {}});
  Imf::FrameBuffer buffers;
  for (ExrChannel& channel : channels) buffers.insert(channel.name, makeSlice(channel, pixels, data));

  Imf::InputPart part(file, index);
  if (!part.isComplete()) source.fail(source.size(), "OpenEXR data ends early");
  part.setFrameBuffer(buffers);
  part.readPixels(data.min.y, data.max.y);
  for (ExrChannel& channel : channels) {
    if (data != display) {
      if (channel.type == ExrType::u32)
        channel.integers = crop(channel.integers, data, display);
      else
        channel.samples = crop(channel.samples, data, display);
    }
    if (channel.type == ExrType::u32) {
      channel.samples.resize(channel.integers.size());
      std::ranges::transform(channel.integers, channel.samples.begin(), [](auto v) { return static_cast<float>(v); });
    }
  }
  return channels;
}

}  // namespace quintet::io
