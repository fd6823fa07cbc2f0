// Reading OpenEXR: scan lines or tiles, one part or several, through OpenEXR's C++ interface and a stream
// over memory. OpenEXR's exceptions end here.
#include "io/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <new>
#include <optional>

#include "base/error.h"
#include "io/exr_header.h"

namespace quintet::io {
namespace {

constexpr std::uint64_t kMaxPictureBytes = std::uint64_t{4} * kMaxImageBytes;  // all channels of decodeExr
// No file of pictures is smaller than this (a constant one under DWAB comes near 1 : 100 000).
constexpr std::uint64_t kBestRatio = std::uint64_t{1} << 20;

class MemoryStream : public Imf::IStream {
 public:
  explicit MemoryStream(const Source& source) : Imf::IStream(source.name.c_str()), source_(source) {}

  bool read(char to[], int count) override {
    if (count < 0 || at_ > source_.size() || static_cast<std::size_t>(count) > source_.size() - at_) {
      ended_ = true;
      throw std::runtime_error("data ends early");
    }
    std::memcpy(to, source_.data() + at_, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
    return at_ < source_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }
  bool ended() const { return ended_; }

 private:
  const Source& source_;
  std::uint64_t at_ = 0;
  bool ended_ = false;
};

// Runs use(file) and turns what OpenEXR throws into a FileError.
template <class Use>
auto withFile(const Source& source, Use&& use) {
  checkExrHeader(source);
  MemoryStream stream(source);
  try {
    Imf::MultiPartInputFile file(stream, 0);
    return use(file);
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    if (stream.ended()) source.fail(source.size(), "OpenEXR data ends early");
    const std::string_view text(error.what());
    source.fail(fmt::format("broken OpenEXR: {}", text.substr(0, text.find('\n'))));
  }
}

// The channels of a part to read, in the order wanted; empty: not this part.
using Select = std::function<std::vector<std::string>(const Imf::ChannelList&)>;

std::vector<std::string> allChannels(const Imf::ChannelList& list) {
  std::vector<std::string> names;
  for (auto it = list.begin(); it != list.end(); ++it) names.emplace_back(it.name());
  return names;
}

// Grey or colour of the layer `prefix` ("" or "name."), with its alpha.
std::vector<std::string> layerChannels(const Imf::ChannelList& list, const std::string& prefix) {
  const auto has = [&](const char* name) { return list.findChannel(prefix + name) != nullptr; };
  std::vector<std::string> names;
  if (has("R") && has("G") && has("B")) {
    names = {prefix + "R", prefix + "G", prefix + "B"};
  } else if (has("Y") && !has("RY") && !has("BY")) {
    names = {prefix + "Y"};
  }
  if (!names.empty() && has("A")) names.push_back(prefix + "A");
  return names;
}

std::vector<std::string> imageChannels(const Imf::ChannelList& list) {
  if (auto names = layerChannels(list, ""); !names.empty()) return names;
  const std::vector<std::string> all = allChannels(list);
  for (const std::string& name : all)
    if (name.ends_with(".R"))
      if (auto names = layerChannels(list, name.substr(0, name.size() - 1)); !names.empty()) return names;
  return all.size() == 1 ? all : std::vector<std::string>{};
}

struct Choice {
  int part = 0;
  std::vector<std::string> channels;
  Imath::Box2i data;
  Imath::Box2i display;
};

std::uint32_t extent(int min, int max) { return static_cast<std::uint32_t>(std::int64_t{max} - min + 1); }

Choice choosePart(const Source& source, Imf::MultiPartInputFile& file, const Select& select, std::uint64_t maxBytes) {
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (header.hasType() && !Imf::isImage(header.type())) continue;
    Choice choice{part, select(header.channels()), header.dataWindow(), header.displayWindow()};
    if (choice.channels.empty()) continue;
    for (const std::string& name : choice.channels)
      if (const Imf::Channel& channel = header.channels()[name]; channel.xSampling != 1 || channel.ySampling != 1)
        source.fail(fmt::format("OpenEXR with the subsampled channel '{}' is not supported", name));
    const std::uint64_t pixelBytes = choice.channels.size() * sizeof(float);
    for (const Imath::Box2i& box : {choice.data, choice.display}) {
      const std::uint64_t width = extent(box.min.x, box.max.x);
      const std::uint64_t height = extent(box.min.y, box.max.y);
      source.checkSize(width, height, maxBytes == kMaxImageBytes ? pixelBytes : 1);
      if (width * height * pixelBytes > maxBytes) source.fail("the OpenEXR channels are too large together");
    }
    source.checkExpansion(std::uint64_t{extent(choice.data.min.x, choice.data.max.x)} *
                              extent(choice.data.min.y, choice.data.max.y) * pixelBytes,
                          kBestRatio);
    return choice;
  }
  source.fail(fmt::format("OpenEXR without channels that make an image (Y; R, G, B; or one alone): {}",
                          fmt::join(allChannels(file.header(0).channels()), ", ")));
}

// The part of `plane` (data window) that the display window shows; 0 elsewhere.
std::vector<float> crop(const std::vector<float>& plane, const Imath::Box2i& data, const Imath::Box2i& display) {
  const std::size_t from = extent(data.min.x, data.max.x);
  const std::size_t to = extent(display.min.x, display.max.x);
  std::vector<float> result(to * extent(display.min.y, display.max.y));
  const int left = std::max(data.min.x, display.min.x);
  const int right = std::min(data.max.x, display.max.x);
  if (left > right) return result;
  for (int y = std::max(data.min.y, display.min.y); y <= std::min(data.max.y, display.max.y); ++y) {
    const float* row = plane.data() + static_cast<std::size_t>(y - data.min.y) * from;
    std::copy(row + (left - data.min.x), row + (right - data.min.x) + 1,
              result.data() + static_cast<std::size_t>(y - display.min.y) * to + (left - display.min.x));
  }
  return result;
}

ExrType storedType(Imf::PixelType type) {
  return type == Imf::HALF ? ExrType::half : type == Imf::UINT ? ExrType::u32 : ExrType::f32;
}

Metadata readStrings(const Imf::Header& header) {
  Metadata metadata;
  for (auto it = header.begin(); it != header.end(); ++it)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute()))
      if (std::string_view(it.name()) != "type") metadata.emplace_back(it.name(), text->value());
  return metadata;
}

ExrPicture readPicture(const Source& source, const Select& select, std::uint64_t maxBytes) {
  return withFile(source, [&](Imf::MultiPartInputFile& file) {
    const Choice choice = choosePart(source, file, select, maxBytes);
    const Imf::Header& header = file.header(choice.part);
    const Imath::Box2i& data = choice.data;
    const std::size_t width = extent(data.min.x, data.max.x);
    const std::size_t height = extent(data.min.y, data.max.y);

    ExrPicture picture{extent(choice.display.min.x, choice.display.max.x),
                       extent(choice.display.min.y, choice.display.max.y),
                       {},
                       readStrings(header)};
    Imf::FrameBuffer buffers;
    for (const std::string& name : choice.channels)
      picture.channels.push_back({name, storedType(header.channels()[name].type), std::vector<float>(width * height)});
    for (ExrChannel& channel : picture.channels)
      buffers.insert(channel.name, Imf::Slice::Make(Imf::FLOAT, channel.samples.data(), data));

    Imf::InputPart part(file, choice.part);
    if (!part.isComplete()) source.fail(source.size(), "OpenEXR data ends early");
    part.setFrameBuffer(buffers);
    part.readPixels(data.min.y, data.max.y);
    if (data != choice.display)
      for (ExrChannel& channel : picture.channels) channel.samples = crop(channel.samples, data, choice.display);
    return picture;
  });
}

ImageInfo probe(const Source& source) {
  return withFile(source, [&](Imf::MultiPartInputFile& file) {
    const Choice choice = choosePart(source, file, imageChannels, kMaxImageBytes);
    return ImageInfo{extent(choice.display.min.x, choice.display.max.x),
                     extent(choice.display.min.y, choice.display.max.y),
                     static_cast<std::uint32_t>(choice.channels.size()),
                     PixelType::f32,
                     {}};
  });
}

Image decode(const Source& source) {
  const ExrPicture picture = readPicture(source, imageChannels, kMaxImageBytes);
  const auto channels = static_cast<std::uint32_t>(picture.channels.size());
  Image image = makeImage(picture.width, picture.height, channels, PixelType::f32, ColorEncoding::linear);
  image.premultiplied = image.hasAlpha();
  const std::span<float> to = image.samples<float>();
  for (std::uint32_t c = 0; c < channels; ++c)
    for (std::size_t i = 0; i < image.pixelCount(); ++i) to[i * channels + c] = picture.channels[c].samples[i];
  return image;
}

Metadata metadata(const Source& source) {
  return withFile(source, [](Imf::MultiPartInputFile& file) { return readStrings(file.header(0)); });
}

}  // namespace

const Format kExr{"OpenEXR", isExr, probe, decode, metadata};

ExrPicture decodeExr(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  const Source source{bytes, nameForErrors};
  if (!isExr(source)) source.fail("not an OpenEXR file");
  try {
    return readPicture(source, allChannels, kMaxPictureBytes);
  } catch (const std::bad_alloc&) {
    source.fail("not enough memory for the image");
  }
}

}  // namespace quintet::io
