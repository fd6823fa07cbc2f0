// Writing OpenEXR: scan lines, ZIP, into memory.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "io/exr.h"
#include "io/formats.h"

namespace quintet::io {
namespace {

class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : Imf::OStream("memory") {}

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

Imf::PixelType pixelType(ExrType type) {
  return type == ExrType::half ? Imf::HALF : type == ExrType::u32 ? Imf::UINT : Imf::FLOAT;
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

// The samples as the file stores them: OpenEXR converts when it reads, not when it writes.
template <class Stored, class Convert>
std::vector<char> convertSamples(const std::vector<float>& samples, Convert&& convert) {
  std::vector<char> bytes(samples.size() * sizeof(Stored));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Stored value = convert(samples[i]);
    std::memcpy(bytes.data() + i * sizeof(Stored), &value, sizeof(Stored));
  }
  return bytes;
}

void checkPicture(const ExrPicture& picture) {
  const std::size_t pixels = std::size_t{picture.width} * picture.height;
  if (pixels == 0 || picture.channels.empty()) throw UsageError("an image without pixels cannot be written as OpenEXR");
  std::vector<std::string> names;
  for (const ExrChannel& channel : picture.channels) {
    if (channel.samples.size() != pixels)
      throw UsageError(fmt::format("the OpenEXR channel '{}' has {} samples for {} x {} pixels", channel.name,
                                   channel.samples.size(), picture.width, picture.height));
    names.push_back(channel.name);
    if (channel.name.empty() || channel.name.size() > 255 || channel.name.find('\0') != std::string::npos)
      throw UsageError(fmt::format("'{}' cannot be the name of an OpenEXR channel", channel.name));
  }
  std::ranges::sort(names);
  if (const auto twice = std::ranges::adjacent_find(names); twice != names.end())
    throw UsageError(fmt::format("the OpenEXR channel '{}' is given twice", *twice));
}

Imf::Header makeHeader(const ExrPicture& picture) {
  Imf::Header header(static_cast<int>(picture.width), static_cast<int>(picture.height));
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const ExrChannel& channel : picture.channels)
    header.channels().insert(channel.name, Imf::Channel(pixelType(channel.type)));
  constexpr std::string_view kReserved[]{"type", "name", "view", "version", "chunkCount", "tiles", "preview"};
  checkMetadata(picture.metadata);
  for (const auto& [key, text] : picture.metadata) {
    if (header.find(key) != header.end() || std::ranges::find(kReserved, key) != std::end(kReserved))
      throw UsageError(fmt::format("the metadata keyword '{}' is given twice or has a meaning in OpenEXR", key));
    header.insert(key, Imf::StringAttribute(text));
  }
  return header;
}

}  // namespace

std::vector<std::byte> encodeExr(const ExrPicture& picture) {
  checkPicture(picture);
  const Imf::Header header = makeHeader(picture);

  std::vector<std::vector<char>> converted;
  converted.reserve(picture.channels.size());
  Imf::FrameBuffer buffers;
  for (const ExrChannel& channel : picture.channels) {
    const void* samples = channel.samples.data();
    if (channel.type == ExrType::half)
      samples = converted.emplace_back(convertSamples<half>(channel.samples, toHalf)).data();
    if (channel.type == ExrType::u32)
      samples = converted.emplace_back(convertSamples<std::uint32_t>(channel.samples, toUnsigned)).data();
    buffers.insert(channel.name, Imf::Slice::Make(pixelType(channel.type), samples, header.dataWindow()));
  }

  MemoryStream stream;
  try {
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(buffers);
    file.writePixels(static_cast<int>(picture.height));
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
