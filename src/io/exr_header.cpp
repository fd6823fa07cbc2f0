// Layout: https://openexr.com/en/latest/OpenEXRFileLayout.html
#include "io/exr_header.h"

#include <fmt/format.h>

namespace quintet::io {
namespace {

constexpr std::uint32_t kMultiPart = 0x1000;
constexpr std::uint64_t kMaxTileArea = std::uint64_t{1} << 26;
constexpr std::size_t kMaxName = 255;
constexpr std::size_t kChunkPointer = 8;  // bytes in the table of chunks

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

  // An empty name: the end of a header, or of the list of headers.
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
      if (at_ - begin > kMaxName) source_.fail(begin, "broken OpenEXR: a name without end");
    }
    return {reinterpret_cast<const char*>(source_.data()) + begin, at_ - 1 - begin};
  }

  void scanPart() {
    Window data;
    Window tile;
    while (!atTerminator()) {
      const std::string_view name = readName();
      readName();  // type
      const std::uint32_t size = read32(at_);
      at_ += 4;
      if (size > source_.size() - at_)
        source_.fail(at_ - 4, fmt::format("broken OpenEXR: the attribute '{}' is larger than the file", name));
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
    // 2^30: OpenEXR adds and subtracts coordinates as int.
    for (std::size_t i = 0; i < 4; ++i)
      if (coordinate(i) < -(1 << 30) || coordinate(i) > 1 << 30)
        source_.fail(at_, fmt::format("broken OpenEXR: the {} is out of range", name));
    source_.checkSize(static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height), 1);
    return {static_cast<std::uint64_t>(width), static_cast<std::uint64_t>(height)};
  }

  const Source& source_;
  std::size_t at_ = 0;
};

}  // namespace

bool isExr(const Source& source) { return source.has(0, "\x76\x2f\x31\x01"); }

void checkExrHeader(const Source& source) { HeaderScan(source).run(); }

}  // namespace quintet::io
