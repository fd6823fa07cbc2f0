// Reading OpenEXR: as a picture of at most four channels, and all of its channels.
#include "io/exr.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "io/exr_attributes.h"
#include "io/exr_check.h"
#include "io/exr_reader.h"

namespace quintet::io {
namespace {

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

std::vector<std::string> imageChannels(const Imf::Header& header) {
  const Imf::ChannelList& list = header.channels();
  if (auto names = layerChannels(list, ""); !names.empty()) return names;
  const std::vector<std::string> all = channelNames(header);
  for (const std::string& name : all)
    if (name.ends_with(".R"))
      if (auto names = layerChannels(list, name.substr(0, name.size() - 1)); !names.empty()) return names;
  return all.size() == 1 ? all : std::vector<std::string>{};
}

struct Choice {
  int part = 0;
  std::vector<std::string> channels;
};

Choice chooseImage(const Source& source, Imf::MultiPartInputFile& file) {
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (!isFlat(header)) continue;
    Choice choice{part, imageChannels(header)};
    if (choice.channels.empty()) continue;
    checkChannels(source, header, choice.channels, kMaxImageBytes);
    return choice;
  }
  source.fail(fmt::format("OpenEXR without channels that make an image (Y; R, G, B; or one alone): {}",
                          fmt::join(channelNames(file.header(0)), ", ")));
}

ImageInfo probe(const Source& source) {
  return withExrFile(source, [&](Imf::MultiPartInputFile& file) {
    const Choice choice = chooseImage(source, file);
    const Imath::Box2i& display = file.header(choice.part).displayWindow();
    return ImageInfo{extent(display.min.x, display.max.x),
                     extent(display.min.y, display.max.y),
                     static_cast<std::uint32_t>(choice.channels.size()),
                     PixelType::f32,
                     {}};
  });
}

Image decode(const Source& source) {
  return withExrFile(source, [&](Imf::MultiPartInputFile& file) {
    const Choice choice = chooseImage(source, file);
    const Imath::Box2i& display = file.header(choice.part).displayWindow();
    const std::vector<ExrChannel> channels = readChannels(source, file, choice.part, choice.channels);
    const auto count = static_cast<std::uint32_t>(channels.size());
    Image image = makeImage(extent(display.min.x, display.max.x), extent(display.min.y, display.max.y), count,
                            PixelType::f32, ColorEncoding::linear);
    image.premultiplied = image.hasAlpha();
    const std::span<float> to = image.samples<float>();
    for (std::uint32_t c = 0; c < count; ++c)
      for (std::size_t i = 0; i < image.pixelCount(); ++i) to[i * count + c] = channels[c].samples[i];
    return image;
  });
}

Metadata metadata(const Source& source) {
  return withExrFile(source, [](Imf::MultiPartInputFile& file) { return readStrings(file.header(0)); });
}

std::vector<int> flatParts(const Source& source, Imf::MultiPartInputFile& file) {
  std::vector<int> parts;
  std::uint64_t bytes = 0;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (!isFlat(header)) continue;
    const std::vector<std::string> names = channelNames(header);
    checkChannels(source, header, names, kMaxPictureBytes);
    const Imath::Box2i& display = header.displayWindow();
    bytes += std::uint64_t{extent(display.min.x, display.max.x)} * extent(display.min.y, display.max.y) * names.size() *
             sizeof(float);
    if (bytes > kMaxPictureBytes) source.fail("the OpenEXR channels are too large together");
    if (!parts.empty() && display != file.header(parts.front()).displayWindow())
      source.fail("OpenEXR with parts of different display windows is not supported");
    parts.push_back(part);
  }
  if (parts.empty()) source.fail("OpenEXR with deep data alone is not supported");
  return parts;
}

ExrPicture readAll(const Source& source) {
  return withExrFile(source, [&](Imf::MultiPartInputFile& file) {
    const std::vector<int> parts = flatParts(source, file);
    const Imf::Header& first = file.header(parts.front());
    const Imath::Box2i& display = first.displayWindow();
    ExrPicture picture{
        extent(display.min.x, display.max.x), extent(display.min.y, display.max.y), {}, readStrings(first)};
    picture.attributes = readAttributes(first);
    for (const int part : parts) {
      const Imf::Header& header = file.header(part);
      for (ExrChannel& channel : readChannels(source, file, part, channelNames(header))) {
        const bool bare = channel.name.find('.') == std::string::npos;
        if (part != parts.front() && bare && header.hasName()) channel.name = header.name() + "." + channel.name;
        const bool known =
            std::ranges::any_of(picture.channels, [&](const ExrChannel& c) { return c.name == channel.name; });
        if (!known) picture.channels.push_back(std::move(channel));
      }
    }
    return picture;
  });
}

}  // namespace

const Format kExr{"OpenEXR", isExr, probe, decode, metadata};

ExrPicture decodeExr(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  const Source source{bytes, nameForErrors};
  if (!isExr(source)) source.fail("not an OpenEXR file");
  try {
    return readAll(source);
  } catch (const std::bad_alloc&) {
    source.fail("not enough memory for the image");
  }
}

}  // namespace quintet::io
