// SPDX-License-Identifier: Apache-2.0
// Encodes OpenEXR in memory: validation, then scan lines or tiles in one part, or in two parts if a lossy compression
// must not change some channels.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfThreading.h>
#include <ImfTiledOutputPart.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <half.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <thread>

#include "base/error.h"
#include "base/plural.h"
#include "io/codec.h"
#include "io/exr/attributes.h"
#include "io/exr/dwa_limits.h"
#include "io/exr/exr.h"
#include "io/formats.h"

namespace quintet::io {
namespace {

// ---- Validation

constexpr float kMaxDwaLevel = 10000.0f;
constexpr std::size_t kMaxNameBytes = 255;

// Dots separate layers. Control characters would end names or lines.
bool isChannelName(const std::string& name) {
  return !name.empty() && name.size() <= kMaxNameBytes && name.front() != '.' && name.back() != '.' &&
         name.find("..") == std::string::npos &&
         std::ranges::all_of(name, [](unsigned char c) { return c >= 32 && c != 127; });
}

void checkChannel(const ExrChannel& channel, std::size_t pixels, const ExrImage& image) {
  if (!isChannelName(channel.name))
    throw UsageError(fmt::format("'{}' cannot be the name of an OpenEXR channel", channel.name));
  if (!channel.integers.empty() && channel.type != ExrType::u32)
    throw UsageError(fmt::format("the OpenEXR channel '{}' has integers, but its type is not u32", channel.name));
  const std::size_t count = channel.integers.empty() ? channel.samples.size() : channel.integers.size();
  if (count != pixels)
    throw UsageError(fmt::format("the OpenEXR channel '{}' has {} for {} x {} pixels", channel.name,
                                 counted(count, "sample"), image.width, image.height));
}

// Returns the window of the image, with the full size for an image that is its own display window.
ExrWindow fullWindow(const ExrImage& image) {
  if (image.window.width > 0 || image.window.height > 0) return image.window;
  return {image.window.x, image.window.y, image.window.x + image.width, image.window.y + image.height};
}

void checkWindow(const ExrImage& image) {
  const ExrWindow window = fullWindow(image);
  if (window.width > kMaxImageSide || window.height > kMaxImageSide)
    throw UsageError(fmt::format("{} x {} pixels are too many for an image; at most {} per side", window.width,
                                 window.height, kMaxImageSide));
  if (std::uint64_t{window.x} + image.width > window.width || std::uint64_t{window.y} + image.height > window.height)
    throw UsageError(fmt::format("{} x {} pixels at {}, {} exceed the image of {} x {} pixels", image.width,
                                 image.height, window.x, window.y, window.width, window.height));
}

// OpenEXR counts the bytes of a tile as int.
void checkTiles(std::size_t channels, std::uint32_t size) {
  if (size > kMaxExrTile)
    throw UsageError(fmt::format("OpenEXR tiles of {} pixels are too large; at most {}", size, kMaxExrTile));
  if (std::uint64_t{size} * size * channels * sizeof(float) > std::numeric_limits<std::int32_t>::max())
    throw UsageError(
        fmt::format("OpenEXR tiles of {} pixels and {} are too large together", size, counted(channels, "channel")));
}

void checkImage(const ExrImage& image) {
  const std::uint64_t pixels = std::uint64_t{image.width} * image.height;
  if (pixels == 0 || image.channels.empty()) throw UsageError("an image without pixels cannot be written as OpenEXR");
  checkWindow(image);
  checkExrSize(image.width, image.height, image.channels.size());
  std::vector<std::string> names;
  for (const ExrChannel& channel : image.channels) {
    checkChannel(channel, pixels, image);
    names.push_back(channel.name);
  }
  std::ranges::sort(names);
  if (const auto twice = std::ranges::adjacent_find(names); twice != names.end())
    throw UsageError(fmt::format("the OpenEXR channel '{}' is given twice", *twice));
}

void checkOptions(const ExrImage& image, const ExrOptions& options) {
  const auto index = static_cast<std::size_t>(options.compression);
  if (index >= exrCompressionNames().size()) throw UsageError("unknown OpenEXR compression");
  const std::string& name = exrCompressionNames()[index];
  checkTiles(image.channels.size(), options.tileSize);
  if (!options.level) return;
  const float level = *options.level;
  switch (options.compression) {
    case ExrCompression::zip:
    case ExrCompression::zips:
      if (!(level >= 1 && level <= 9) || std::floor(level) != level)
        throw UsageError(fmt::format("the level of {} must be an integer from 1 to 9, not {}", name, level));
      return;
    case ExrCompression::dwaa:
    case ExrCompression::dwab:
      if (!(level >= 0 && level <= kMaxDwaLevel))
        throw UsageError(
            fmt::format("the level of {} must be a number from 0 to {}, not {}", name, kMaxDwaLevel, level));
      return;
    default: throw UsageError(fmt::format("the compression {} has no level", name));
  }
}

// ---- Writing

// OpenEXR's output stream over memory.
class WriteStream : public Imf::OStream {
 public:
  WriteStream() : Imf::OStream("memory") {}

  void write(const char from[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (at_ + size > bytes_.size()) bytes_.resize(at_ + size);
    std::memcpy(bytes_.data() + at_, from, size);
    at_ += size;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
  std::size_t at_ = 0;
};

constexpr std::uint32_t kBlockRows = 256;  // a multiple of the rows that every compression method combines
constexpr std::uint64_t kScratchBytes = std::uint64_t{256} << 20;  // of samples that are converted at a time
constexpr std::uint64_t kLargeSamples = std::uint64_t{1} << 21;    // from which on threads pay off

using Channels = std::vector<const ExrChannel*>;

struct Part {
  std::string name;
  Channels channels;
  ExrCompression compression;
  std::optional<float> level;
};

bool isLossy(ExrCompression compression) {
  return compression == ExrCompression::dwaa || compression == ExrCompression::dwab;
}

bool hasPlainChannels(const Part& part) {
  return std::ranges::any_of(part.channels, [](const ExrChannel* c) { return c->name.find('.') == std::string::npos; });
}

// Channels that a lossy compression must not change get their own part. The part with channels without a layer comes
// first, because readers display the first part and treat such channels of a later part as a layer with the part's
// name.
std::vector<Part> splitParts(const ExrImage& image, const ExrOptions& options) {
  Part all{"rgba", {}, options.compression, options.level};
  Part data{"data", {}, ExrCompression::zip, std::nullopt};
  for (const ExrChannel& channel : image.channels)
    (isLossy(options.compression) && channel.exact ? data : all).channels.push_back(&channel);
  std::vector<Part> parts;
  for (Part& part : {std::ref(all), std::ref(data)})
    if (!part.channels.empty()) parts.push_back(std::move(part));
  std::stable_partition(parts.begin(), parts.end(), hasPlainChannels);
  return parts;
}

Imf::Compression compressionOf(ExrCompression compression) {
  switch (compression) {
    case ExrCompression::none: return Imf::NO_COMPRESSION;
    case ExrCompression::rle: return Imf::RLE_COMPRESSION;
    case ExrCompression::zips: return Imf::ZIPS_COMPRESSION;
    case ExrCompression::zip: return Imf::ZIP_COMPRESSION;
    case ExrCompression::piz: return Imf::PIZ_COMPRESSION;
    case ExrCompression::dwaa: return Imf::DWAA_COMPRESSION;
    case ExrCompression::dwab: return Imf::DWAB_COMPRESSION;
  }
  return Imf::ZIP_COMPRESSION;
}

Imf::PixelType pixelType(ExrType type) {
  return type == ExrType::half ? Imf::HALF : type == ExrType::u32 ? Imf::UINT : Imf::FLOAT;
}

Imath::Box2i box(std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height) {
  return {{static_cast<int>(x), static_cast<int>(y)},
          {static_cast<int>(x + width) - 1, static_cast<int>(y + height) - 1}};
}

Imf::Header makeHeader(const ExrImage& image, const Part& part, const ExrOptions& options, bool several) {
  const ExrWindow window = fullWindow(image);
  Imf::Header header(box(0, 0, window.width, window.height), box(window.x, window.y, image.width, image.height));
  header.compression() = compressionOf(part.compression);
  if (part.level && isLossy(part.compression)) header.dwaCompressionLevel() = *part.level;
  if (part.level && !isLossy(part.compression)) header.zipCompressionLevel() = static_cast<int>(*part.level);
  for (const ExrChannel* channel : part.channels)
    header.channels().insert(channel->name, Imf::Channel(pixelType(channel->type)));
  if (options.tileSize > 0) header.setTileDescription(Imf::TileDescription(options.tileSize, options.tileSize));
  if (several) header.setName(part.name);
  header.setType(options.tileSize > 0 ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
  addMetadata(header, image.metadata);
  addAttributes(header, image.attributes);
  return header;
}

half toHalf(float value) {
  // Rounding would turn finite values above the largest half into infinity.
  return std::isfinite(value) ? half(std::clamp(value, -65504.0f, 65504.0f)) : half(value);
}

std::uint32_t toUnsigned(float value) {
  if (!(value > 0.0f)) return 0;
  return value >= 4294967296.0f ? 0xffffffffu
                                : static_cast<std::uint32_t>(std::floor(static_cast<double>(value) + 0.5));
}

template <class Stored, class Convert>
void convertInto(std::vector<char>& bytes, std::span<const float> samples, Convert&& convert) {
  bytes.resize(samples.size() * sizeof(Stored));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Stored value = convert(samples[i]);
    std::memcpy(bytes.data() + i * sizeof(Stored), &value, sizeof(Stored));
  }
}

// Returns rows of one channel in the stored type. OpenEXR converts types when it reads, but not when it writes. `limits`
// can be null.
const void* storedRows(const ExrChannel& channel, std::size_t first, std::size_t count, const DwaLimits* limits,
                       std::vector<char>& scratch) {
  if (channel.type == ExrType::u32 && !channel.integers.empty()) return channel.integers.data() + first;
  std::span<const float> samples = std::span(channel.samples).subspan(first, count);
  std::vector<float> limited;
  if (limits) {
    limited.assign(samples.begin(), samples.end());
    limits->clamp(channel, first, limited);
    samples = limited;
    if (channel.type == ExrType::f32) convertInto<float>(scratch, samples, [](float v) { return v; });
  }
  if (channel.type == ExrType::f32) return limits ? static_cast<const void*>(scratch.data()) : samples.data();
  if (channel.type == ExrType::half)
    convertInto<half>(scratch, samples, toHalf);
  else
    convertInto<std::uint32_t>(scratch, samples, toUnsigned);
  return scratch.data();
}

// Returns the number of compression threads. They start with the first large image and stay. The number does not affect
// the encoded bytes.
int threadsFor(const ExrImage& image) {
  const std::uint64_t samples = std::uint64_t{image.width} * image.height * image.channels.size();
  if (samples < kLargeSamples) return 0;
  static const int kThreads = [] {
    const int count = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 16u));
    Imf::setGlobalThreadCount(count);
    return count;
  }();
  return kThreads;
}

// Returns the number of rows to convert at a time: all, or as many as the scratch memory allows.
std::uint32_t blockRows(const ExrImage& image, std::size_t channels) {
  const std::uint64_t rows = kScratchBytes / (std::uint64_t{image.width} * channels * sizeof(float));
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(rows / kBlockRows * kBlockRows, kBlockRows, 1u << 20));
}

// Writes a part in blocks, so that converted samples need little memory.
class PartWriter {
 public:
  // `limits` can be null.
  PartWriter(const ExrImage& image, const Part& part, std::uint32_t tileSize, const DwaLimits* limits)
      : image_(image), part_(part), tileSize_(tileSize), limits_(limits), scratch_(part.channels.size()) {}

  void write(Imf::MultiPartOutputFile& file, int index) {
    if (tileSize_ > 0) {
      Imf::TiledOutputPart out(file, index);
      for (std::uint32_t y = 0; y < image_.height; y += tileSize_) {
        out.setFrameBuffer(rows(y, tileSize_));
        const int row = static_cast<int>(y / tileSize_);
        out.writeTiles(0, out.numXTiles() - 1, row, row);
      }
    } else {
      Imf::OutputPart out(file, index);
      const std::uint32_t block = blockRows(image_, part_.channels.size());
      for (std::uint32_t y = 0; y < image_.height; y += block) {
        out.setFrameBuffer(rows(y, block));
        out.writePixels(static_cast<int>(std::min(block, image_.height - y)));
      }
    }
  }

 private:
  Imf::FrameBuffer rows(std::uint32_t y, std::uint32_t count) {
    count = std::min(count, image_.height - y);
    const std::size_t width = image_.width;
    Imf::FrameBuffer buffers;
    for (std::size_t c = 0; c < part_.channels.size(); ++c) {
      const ExrChannel& channel = *part_.channels[c];
      const void* stored = storedRows(channel, y * width, count * width, limits_, scratch_[c]);
      buffers.insert(channel.name, Imf::Slice::Make(pixelType(channel.type), stored,
                                                    box(image_.window.x, image_.window.y + y, image_.width, count)));
    }
    return buffers;
  }

  const ExrImage& image_;
  const Part& part_;
  const std::uint32_t tileSize_;
  const DwaLimits* limits_;
  std::vector<std::vector<char>> scratch_;
};

// `limits`: of the parts with DWA.
std::vector<std::byte> encodeParts(const ExrImage& image, const ExrOptions& options, const std::vector<Part>& parts,
                                   const DwaLimits* limits) {
  std::vector<Imf::Header> headers;
  for (const Part& part : parts) headers.push_back(makeHeader(image, part, options, parts.size() > 1));
  WriteStream stream;
  try {
    Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()), false, threadsFor(image));
    for (std::size_t i = 0; i < parts.size(); ++i)
      PartWriter(image, parts[i], options.tileSize, isLossy(parts[i].compression) ? limits : nullptr)
          .write(file, static_cast<int>(i));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(fmt::format("cannot encode an OpenEXR file: {}", error.what()));
  }
  return stream.take();
}

constexpr float kDefaultDwaLevel = 45.0f;  // of OpenEXR
constexpr int kDwaAttempts = 8;

}  // namespace

const std::vector<std::string>& exrCompressionNames() {
  static const std::vector<std::string> kNames{"none", "rle", "zips", "zip", "piz", "dwaa", "dwab"};
  return kNames;
}

void checkExrSize(std::uint32_t width, std::uint32_t height, std::size_t channels, std::uint32_t tileSize) {
  if (channels > kMaxExrChannels)
    throw UsageError(
        fmt::format("{} channels are too many for an OpenEXR file; at most {}", channels, kMaxExrChannels));
  if (std::uint64_t{width} * height * channels * sizeof(float) > kMaxExrBytes)
    throw UsageError(fmt::format("one OpenEXR file cannot hold {} of {} x {} pixels; at most {} GiB",
                                 counted(channels, "channel"), width, height, kMaxExrBytes >> 30));
  checkTiles(channels, tileSize);
}

std::vector<std::byte> encodeExr(const ExrImage& image, const ExrOptions& options) {
  checkImage(image);
  checkOptions(image, options);
  std::vector<Part> parts = splitParts(image, options);
  const auto lossy = std::ranges::find_if(parts, [](const Part& part) { return isLossy(part.compression); });
  if (lossy == parts.end()) return encodeParts(image, options, parts, nullptr);

  DwaLimits limits(image, lossy->channels, options.tileSize);
  const bool check = limits.canOverflow(lossy->level.value_or(kDefaultDwaLevel));
  for (int attempt = 0; attempt < kDwaAttempts; ++attempt) {
    std::vector<std::byte> bytes = encodeParts(image, options, parts, &limits);
    if (!check || !limits.tighten(bytes, static_cast<int>(lossy - parts.begin()))) return bytes;
  }
  lossy->compression = ExrCompression::zip;
  lossy->level.reset();
  return encodeParts(image, options, parts, nullptr);
}

std::vector<std::byte> encodeExr(const Image& image, const Metadata& metadata) {
  checkEncodable(image, "OpenEXR");
  const Image linear = toPremultiplied(image);
  constexpr const char* kNames[4][4]{{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
  ExrImage exrImage{image.width, image.height, {}, metadata};
  const std::span<const float> samples = linear.samples<float>();
  for (std::uint32_t c = 0; c < image.channels; ++c) {
    ExrChannel& channel = exrImage.channels.emplace_back();
    channel.name = kNames[image.channels - 1][c];
    channel.samples.resize(image.pixelCount());
    for (std::size_t i = 0; i < channel.samples.size(); ++i) channel.samples[i] = samples[i * image.channels + c];
  }
  return encodeExr(exrImage);
}

}  // namespace quintet::io
