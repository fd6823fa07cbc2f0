// What an OpenEXR file says about itself, and one of its layers as a picture.
#include <ImfTileDescription.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "base/nearest_name.h"
#include "io/exr.h"
#include "io/exr_attributes.h"
#include "io/exr_check.h"
#include "io/exr_reader.h"

namespace quintet::io {
namespace {

const std::string kBeauty = "beauty";  // how people call the channels without a layer

std::string compressionText(const Imf::Header& header) {
  switch (header.compression()) {
    case Imf::NO_COMPRESSION: return "none";
    case Imf::RLE_COMPRESSION: return "rle";
    case Imf::ZIPS_COMPRESSION: return "zips";
    case Imf::ZIP_COMPRESSION: return "zip";
    case Imf::PIZ_COMPRESSION: return "piz";
    case Imf::PXR24_COMPRESSION: return "pxr24";
    case Imf::B44_COMPRESSION: return "b44";
    case Imf::B44A_COMPRESSION: return "b44a";
    case Imf::DWAA_COMPRESSION: return "dwaa";
    case Imf::DWAB_COMPRESSION: return "dwab";
    default: return "unknown";
  }
}

ExrPartInfo::Window window(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, extent(box.min.x, box.max.x), extent(box.min.y, box.max.y)};
}

ExrPartInfo describePart(const Imf::Header& header) {
  ExrPartInfo part;
  if (header.hasName()) part.name = header.name();
  part.compression = compressionText(header);
  if (header.hasTileDescription()) {
    part.tileWidth = header.tileDescription().xSize;
    part.tileHeight = header.tileDescription().ySize;
  }
  part.deep = !isFlat(header);
  part.data = window(header.dataWindow());
  part.display = window(header.displayWindow());
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it)
    part.channels.push_back({it.name(), storedType(it.channel().type)});
  part.attributes = describeAttributes(header);
  return part;
}

// The order of a layer's channels in a picture.
std::size_t rankOf(std::string_view channel) {
  constexpr std::array<std::string_view, 20> kOrder{"Y", "R", "G", "B", "X", "x", "y",   "Z",     "z",    "W",
                                                    "w", "U", "u", "V", "v", "A", "red", "green", "blue", "alpha"};
  const std::string_view suffix = channel.substr(channel.rfind('.') + 1);
  const bool isY = suffix == "Y" && channel.find('.') != channel.npos;  // normal.Y: after X
  return isY ? 5 : static_cast<std::size_t>(std::ranges::find(kOrder, suffix) - kOrder.begin());
}

struct Layer {
  int part = 0;
  std::vector<std::string> channels;
};

// The name under which decodeExr has a channel.
std::string fullName(const Imf::Header& header, int part, const std::string& channel) {
  const bool bare = channel.find('.') == std::string::npos;
  return part > 0 && bare && header.hasName() ? header.name() + "." + channel : channel;
}

// The channels of the part that has them; `layers` collects what there is.
Layer collectLayer(Imf::MultiPartInputFile& file, const std::string& wanted, std::vector<std::string>& layers) {
  Layer found;
  for (int part = 0; part < file.parts() && found.channels.empty(); ++part) {
    const Imf::Header& header = file.header(part);
    if (!isFlat(header)) continue;
    for (const std::string& channel : channelNames(header)) {
      const std::string name = fullName(header, part, channel);
      if (name == wanted) return {part, {channel}};
      const std::string layer(exrLayerOf(name));
      if (layer == wanted) found.channels.push_back(channel), found.part = part;
      const std::string shown = layer.empty() ? kBeauty : layer;
      if (std::ranges::find(layers, shown) == layers.end()) layers.push_back(shown);
    }
  }
  return found;
}

Layer findLayer(const Source& source, Imf::MultiPartInputFile& file, const std::string& wanted) {
  std::vector<std::string> layers;
  Layer found = collectLayer(file, wanted, layers);
  if (found.channels.empty() && wanted == kBeauty) found = collectLayer(file, "", layers);
  if (found.channels.empty()) {
    const std::string nearest = nearestName(wanted, layers);
    throw UsageError(
        fmt::format("{}: there is no layer '{}'{}; there are {}", source.name, wanted.empty() ? kBeauty : wanted,
                    nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest), fmt::join(layers, ", ")));
  }
  std::ranges::stable_sort(found.channels, {}, rankOf);
  return found;
}

// Without a layer's name there may be others beside the colours (a plain Z).
void keepColours(std::vector<std::string>& channels) {
  const auto has = [&](const char* name) { return std::ranges::find(channels, name) != channels.end(); };
  if (has("R") && has("G") && has("B"))
    std::erase_if(channels,
                  [](const std::string& name) { return name != "R" && name != "G" && name != "B" && name != "A"; });
}

Image toImage(const std::vector<ExrChannel>& channels, const Imath::Box2i& display) {
  const auto count = static_cast<std::uint32_t>(channels.size());
  const bool grey = count == 2 && channels.back().name.ends_with('A');
  const std::uint32_t stored = count == 2 && !grey ? 3 : count;
  Image image = makeImage(extent(display.min.x, display.max.x), extent(display.min.y, display.max.y), stored,
                          PixelType::f32, ColorEncoding::linear);
  image.premultiplied = image.hasAlpha();
  const std::span<float> to = image.samples<float>();
  for (std::uint32_t c = 0; c < count; ++c)
    for (std::size_t i = 0; i < image.pixelCount(); ++i) to[i * stored + c] = channels[c].samples[i];
  return image;
}

}  // namespace

std::string_view exrLayerOf(std::string_view channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == channel.npos ? std::string_view{} : channel.substr(0, dot);
}

bool isOpenExr(std::span<const std::byte> bytes) {
  const std::string name;
  return isExr({bytes, name});
}

std::vector<ExrPartInfo> inspectExr(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  const Source source{bytes, nameForErrors};
  if (!isExr(source)) source.fail("not an OpenEXR file");
  return withExrFile(source, [](Imf::MultiPartInputFile& file) {
    std::vector<ExrPartInfo> parts;
    for (int part = 0; part < file.parts(); ++part) parts.push_back(describePart(file.header(part)));
    return parts;
  });
}

Image decodeExrLayer(std::span<const std::byte> bytes, const std::string& nameForErrors, const std::string& layer) {
  const Source source{bytes, nameForErrors};
  if (!isExr(source)) source.fail("not an OpenEXR file: it has no layers");
  try {
    return withExrFile(source, [&](Imf::MultiPartInputFile& file) {
      Layer found = findLayer(source, file, layer);
      keepColours(found.channels);
      if (found.channels.size() > 4)
        source.fail(fmt::format("the layer '{}' has {} channels: name one ('{}')", layer, found.channels.size(),
                                found.channels.front()));
      const Imf::Header& header = file.header(found.part);
      checkChannels(source, header, found.channels, kMaxImageBytes);
      return toImage(readChannels(source, file, found.part, found.channels), header.displayWindow());
    });
  } catch (const std::bad_alloc&) {
    source.fail("not enough memory for the image");
  }
}

}  // namespace quintet::io
