#include "io/exr_reader.h"

#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfPartType.h>
#include <fmt/format.h>

#include <algorithm>

namespace quintet::io {
namespace {

// No file of pictures is smaller than this (a constant one under DWAB comes near 1 : 100 000).
constexpr std::uint64_t kBestRatio = std::uint64_t{1} << 20;

// The part of `plane` (data window) that the display window shows; 0 elsewhere.
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

// What a channel's buffer is read as, and room for it.
Imf::Slice makeSlice(ExrChannel& channel, std::size_t pixels, const Imath::Box2i& data) {
  if (channel.type == ExrType::u32) {
    channel.integers.resize(pixels);
    return Imf::Slice::Make(Imf::UINT, channel.integers.data(), data);
  }
  channel.samples.resize(pixels);
  return Imf::Slice::Make(Imf::FLOAT, channel.samples.data(), data);
}

}  // namespace

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
