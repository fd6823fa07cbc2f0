// Writing OpenEXR into memory: scan lines or tiles, one part, or two where colours may lose bits and data may not.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
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
#include <new>
#include <thread>

#include "base/error.h"
#include "io/exr.h"
#include "io/exr_attributes.h"
#include "io/exr_check.h"
#include "io/exr_stream.h"

namespace quintet::io {
namespace {

constexpr std::uint32_t kBlockRows = 256;  // a multiple of what every compression takes together
constexpr std::uint64_t kScratchBytes = std::uint64_t{256} << 20;  // of samples converted at a time
constexpr std::uint64_t kLargeSamples = std::uint64_t{1} << 21;    // from here on threads are worth their start

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

bool hasPicture(const Part& part) {
  return std::ranges::any_of(part.channels, [](const ExrChannel* c) { return c->name.find('.') == std::string::npos; });
}

// What a lossy compression must not touch goes to a part of its own. The picture, channels without a layer, comes first:
// readers show the first part, and names that a later part leaves bare belong to a layer of its name.
std::vector<Part> splitParts(const ExrPicture& picture, const ExrOptions& options) {
  Part all{"rgba", {}, options.compression, options.level};
  Part data{"data", {}, ExrCompression::zip, std::nullopt};
  for (const ExrChannel& channel : picture.channels)
    (isLossy(options.compression) && channel.exact ? data : all).channels.push_back(&channel);
  std::vector<Part> parts;
  for (Part& part : {std::ref(all), std::ref(data)})
    if (!part.channels.empty()) parts.push_back(std::move(part));
  std::ranges::stable_partition(parts, hasPicture);
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

Imf::Header makeHeader(const ExrPicture& picture, const Part& part, const ExrOptions& options, bool several) {
  const ExrPlace place = wholePlace(picture);
  Imf::Header header(box(0, 0, place.width, place.height), box(place.x, place.y, picture.width, picture.height));
  header.compression() = compressionOf(part.compression);
  if (part.level && isLossy(part.compression)) header.dwaCompressionLevel() = *part.level;
  if (part.level && !isLossy(part.compression)) header.zipCompressionLevel() = static_cast<int>(*part.level);
  for (const ExrChannel* channel : part.channels)
    header.channels().insert(channel->name, Imf::Channel(pixelType(channel->type)));
  if (options.tileSize > 0) header.setTileDescription(Imf::TileDescription(options.tileSize, options.tileSize));
  if (several) header.setName(part.name);
  header.setType(options.tileSize > 0 ? Imf::TILEDIMAGE : Imf::SCANLINEIMAGE);
  addMetadata(header, picture.metadata);
  addAttributes(header, picture.attributes);
  return header;
}

half toHalf(float value) {
  // Rounding would make the finite values beyond half's largest infinite.
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

// Rows of one channel as the file stores them: OpenEXR converts when it reads, not when it writes.
const void* storedRows(const ExrChannel& channel, std::size_t first, std::size_t count, std::vector<char>& scratch) {
  if (channel.type == ExrType::u32 && !channel.integers.empty()) return channel.integers.data() + first;
  const std::span<const float> samples = std::span(channel.samples).subspan(first, count);
  if (channel.type == ExrType::f32) return samples.data();
  if (channel.type == ExrType::half)
    convertInto<half>(scratch, samples, toHalf);
  else
    convertInto<std::uint32_t>(scratch, samples, toUnsigned);
  return scratch.data();
}

// Threads that compress; started with the first large picture and kept. The bytes do not depend on them.
int threadsFor(const ExrPicture& picture) {
  const std::uint64_t samples = std::uint64_t{picture.width} * picture.height * picture.channels.size();
  if (samples < kLargeSamples) return 0;
  static const int kThreads = [] {
    const int count = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 16u));
    Imf::setGlobalThreadCount(count);
    return count;
  }();
  return kThreads;
}

// Rows to convert at a time: all of them, or as many as scratch memory allows.
std::uint32_t blockRows(const ExrPicture& picture, std::size_t channels) {
  const std::uint64_t rows = kScratchBytes / (std::uint64_t{picture.width} * channels * sizeof(float));
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(rows / kBlockRows * kBlockRows, kBlockRows, 1u << 20));
}

// Writes a part block by block, so that converted samples take little memory.
class PartWriter {
 public:
  PartWriter(const ExrPicture& picture, const Part& part, std::uint32_t tileSize)
      : picture_(picture), part_(part), tileSize_(tileSize), scratch_(part.channels.size()) {}

  void write(Imf::MultiPartOutputFile& file, int index) {
    if (tileSize_ > 0) {
      Imf::TiledOutputPart out(file, index);
      for (std::uint32_t y = 0; y < picture_.height; y += tileSize_) {
        out.setFrameBuffer(rows(y, tileSize_));
        const int row = static_cast<int>(y / tileSize_);
        out.writeTiles(0, out.numXTiles() - 1, row, row);
      }
    } else {
      Imf::OutputPart out(file, index);
      const std::uint32_t block = blockRows(picture_, part_.channels.size());
      for (std::uint32_t y = 0; y < picture_.height; y += block) {
        out.setFrameBuffer(rows(y, block));
        out.writePixels(static_cast<int>(std::min(block, picture_.height - y)));
      }
    }
  }

 private:
  Imf::FrameBuffer rows(std::uint32_t y, std::uint32_t count) {
    count = std::min(count, picture_.height - y);
    const std::size_t width = picture_.width;
    Imf::FrameBuffer buffers;
    for (std::size_t c = 0; c < part_.channels.size(); ++c) {
      const ExrChannel& channel = *part_.channels[c];
      const void* stored = storedRows(channel, y * width, count * width, scratch_[c]);
      buffers.insert(channel.name,
                     Imf::Slice::Make(pixelType(channel.type), stored,
                                      box(picture_.place.x, picture_.place.y + y, picture_.width, count)));
    }
    return buffers;
  }

  const ExrPicture& picture_;
  const Part& part_;
  const std::uint32_t tileSize_;
  std::vector<std::vector<char>> scratch_;
};

}  // namespace

std::vector<std::byte> encodeExr(const ExrPicture& picture, const ExrOptions& options) {
  checkExrPicture(picture);
  checkExrOptions(picture, options);
  const std::vector<Part> parts = splitParts(picture, options);
  std::vector<Imf::Header> headers;
  for (const Part& part : parts) headers.push_back(makeHeader(picture, part, options, parts.size() > 1));

  ExrWriteStream stream;
  try {
    Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()), false, threadsFor(picture));
    for (std::size_t i = 0; i < parts.size(); ++i)
      PartWriter(picture, parts[i], options.tileSize).write(file, static_cast<int>(i));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw Error(fmt::format("an OpenEXR file could not be made: {}", error.what()));
  }
  return stream.take();
}

std::vector<std::byte> encodeExr(const Image& image, const Metadata& metadata) {
  checkEncodable(image, "OpenEXR");
  const Image linear = toPremultiplied(image);
  constexpr const char* kNames[4][4]{{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
  ExrPicture picture{image.width, image.height, {}, metadata};
  const std::span<const float> samples = linear.samples<float>();
  for (std::uint32_t c = 0; c < image.channels; ++c) {
    ExrChannel& channel = picture.channels.emplace_back();
    channel.name = kNames[image.channels - 1][c];
    channel.samples.resize(image.pixelCount());
    for (std::size_t i = 0; i < channel.samples.size(); ++i) channel.samples[i] = samples[i * image.channels + c];
  }
  return encodeExr(picture);
}

}  // namespace quintet::io
