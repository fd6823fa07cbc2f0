// SPDX-License-Identifier: Apache-2.0
// Decodes OpenEXR: an image of up to four channels, one layer, or all channels.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <new>

#include "base/memory_budget.h"
#include "base/suggestion.h"
#include "base/text.h"
#include "io/exr/attributes.h"
#include "io/exr/exr.h"
#include "io/exr/read.h"
#include "io/formats.h"

namespace quintet::io {
namespace {

const std::string kBeauty = "beauty";  // conventional name of the channels without a layer

// Returns the gray or color channels and the alpha channel of the layer `prefix` ("" or "name.").
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

// The channels of one part that form an image.
struct PartChannels {
  int part = 0;
  std::vector<std::string> channels;
};

PartChannels chooseImage(const Source& source, Imf::MultiPartInputFile& file) {
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (!isFlat(header)) continue;
    PartChannels choice{part, imageChannels(header)};
    if (choice.channels.empty()) continue;
    checkChannels(source, header, choice.channels, kMaxImageBytes);
    return choice;
  }
  source.fail(fmt::format("no image channels in the OpenEXR file (Y; R, G, B; or a single channel); available: {}",
                          fmt::join(channelNames(file.header(0)), ", ")));
}

// Interleaves channels. Two become three with a last one of 0, unless the second is alpha.
Image toImage(const std::vector<ExrChannel>& channels, const Imath::Box2i& display) {
  const auto count = static_cast<std::uint32_t>(channels.size());
  const bool gray = count == 2 && channels.back().name.ends_with('A');
  const std::uint32_t stored = count == 2 && !gray ? 3 : count;
  Image image = makeImage(extent(display.min.x, display.max.x), extent(display.min.y, display.max.y), stored,
                          PixelType::f32, ColorEncoding::linear);
  image.premultiplied = image.hasAlpha();
  const std::span<float> to = image.samples<float>();
  for (std::uint32_t c = 0; c < count; ++c)
    for (std::size_t i = 0; i < image.pixelCount(); ++i) to[i * stored + c] = channels[c].samples[i];
  return image;
}

ImageInfo infoOf(const Imf::Header& header, std::size_t channels) {
  const Imath::Box2i& display = header.displayWindow();
  return {extent(display.min.x, display.max.x),
          extent(display.min.y, display.max.y),
          static_cast<std::uint32_t>(channels),
          PixelType::f32,
          {},
          channelBytes(header, channels)};
}

ImageInfo probe(const Source& source) {
  return withExrFile(source, [&](Imf::MultiPartInputFile& file) {
    const PartChannels choice = chooseImage(source, file);
    return infoOf(file.header(choice.part), choice.channels.size());
  });
}

Image decode(const Source& source) {
  return withExrFile(source, [&](Imf::MultiPartInputFile& file) {
    const PartChannels choice = chooseImage(source, file);
    const Imath::Box2i& display = file.header(choice.part).displayWindow();
    return toImage(readChannels(source, file, choice.part, choice.channels), display);
  });
}

Metadata metadata(const Source& source) {
  return withExrFile(source, [](Imf::MultiPartInputFile& file) { return readStrings(file.header(0)); });
}

// Returns the parts without deep data after checking that their channels fit into memory together.
std::vector<int> flatParts(const Source& source, Imf::MultiPartInputFile& file) {
  std::vector<int> parts;
  std::uint64_t bytes = 0;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    if (!isFlat(header)) continue;
    const std::vector<std::string> names = channelNames(header);
    checkChannels(source, header, names, kMaxExrBytes);
    const Imath::Box2i& display = header.displayWindow();
    bytes += std::uint64_t{extent(display.min.x, display.max.x)} * extent(display.min.y, display.max.y) * names.size() *
             sizeof(float);
    if (bytes > kMaxExrBytes) source.fail("the OpenEXR channels are too large together");
    if (!parts.empty() && display != file.header(parts.front()).displayWindow())
      source.fail("OpenEXR with parts of different display windows is not supported");
    parts.push_back(part);
  }
  if (parts.empty()) source.fail("OpenEXR with only deep data is not supported");
  return parts;
}

ExrImage readAll(const Source& source, MemoryBudget& budget) {
  return withExrFile(source, [&](Imf::MultiPartInputFile& file) {
    const std::vector<int> parts = flatParts(source, file);
    for (const int part : parts) budget.take(channelBytes(file.header(part), channelNames(file.header(part)).size()));
    const Imf::Header& first = file.header(parts.front());
    const Imath::Box2i& display = first.displayWindow();
    ExrImage image{extent(display.min.x, display.max.x), extent(display.min.y, display.max.y), {}, readStrings(first)};
    image.attributes = readAttributes(first);
    for (const int part : parts) {
      const Imf::Header& header = file.header(part);
      for (ExrChannel& channel : readChannels(source, file, part, channelNames(header))) {
        channel.name = fullChannelName(header, part == parts.front(), channel.name);
        const bool known =
            std::ranges::any_of(image.channels, [&](const ExrChannel& c) { return c.name == channel.name; });
        if (!known) image.channels.push_back(std::move(channel));
      }
    }
    return image;
  });
}

// Returns the rank of a channel in the order of an image's channels.
std::size_t rankOf(std::string_view channel) {
  constexpr std::array<std::string_view, 20> kOrder{"Y", "R", "G", "B", "X", "x", "y",   "Z",     "z",    "W",
                                                    "w", "U", "u", "V", "v", "A", "red", "green", "blue", "alpha"};
  const std::string_view suffix = channel.substr(channel.rfind('.') + 1);
  const bool isY = suffix == "Y" && channel.find('.') != channel.npos;  // normal.Y follows normal.X
  return isY ? 5 : static_cast<std::size_t>(std::ranges::find(kOrder, suffix) - kOrder.begin());
}

// Returns the channels of a layer in the first part that has it; `layers` collects the names of all layers.
PartChannels collectLayer(Imf::MultiPartInputFile& file, const std::string& wanted, std::vector<std::string>& layers) {
  PartChannels found;
  for (int part = 0; part < file.parts() && found.channels.empty(); ++part) {
    const Imf::Header& header = file.header(part);
    if (!isFlat(header)) continue;
    for (const std::string& channel : channelNames(header)) {
      const std::string name = fullChannelName(header, part == 0, channel);
      if (name == wanted) return {part, {channel}};
      const std::string layer(exrLayerOf(name));
      if (layer == wanted) found.channels.push_back(channel), found.part = part;
      const std::string shown = layer.empty() ? kBeauty : layer;
      if (std::ranges::find(layers, shown) == layers.end()) layers.push_back(shown);
    }
  }
  return found;
}

PartChannels findLayer(const Source& source, Imf::MultiPartInputFile& file, const std::string& wanted) {
  std::vector<std::string> layers;
  PartChannels found = collectLayer(file, wanted, layers);
  if (found.channels.empty() && wanted == kBeauty) found = collectLayer(file, "", layers);
  if (found.channels.empty()) {
    throw UsageError(
        printable(fmt::format("{}: no layer '{}'{}; available: {}", source.name, wanted.empty() ? kBeauty : wanted,
                              suggestion(wanted, layers), fmt::join(layers, ", "))));
  }
  std::ranges::stable_sort(found.channels, {}, rankOf);
  return found;
}

// Removes channels such as a plain Z beside R, G, B.
void keepColors(std::vector<std::string>& channels) {
  const auto has = [&](const char* name) { return std::ranges::find(channels, name) != channels.end(); };
  if (has("R") && has("G") && has("B"))
    std::erase_if(channels,
                  [](const std::string& name) { return name != "R" && name != "G" && name != "B" && name != "A"; });
}

}  // namespace

const Format kExr{"OpenEXR", isExr, probe, decode, metadata};

ExrImage decodeExr(std::span<const std::byte> bytes, const std::string& nameForErrors) {
  MemoryBudget budget(nameForErrors, 0, Remedy::none);
  return decodeExr(bytes, nameForErrors, budget);
}

ExrImage decodeExr(std::span<const std::byte> bytes, const std::string& nameForErrors, MemoryBudget& budget) {
  const Source source{bytes, nameForErrors};
  if (!isExr(source)) source.fail("not an OpenEXR file");
  try {
    return readAll(source, budget);
  } catch (const std::bad_alloc&) {
    source.fail("not enough memory for the image");
  }
}

std::string_view exrLayerOf(std::string_view channel) {
  const std::size_t dot = channel.rfind('.');
  return dot == channel.npos ? std::string_view{} : channel.substr(0, dot);
}

Image decodeExrLayer(std::span<const std::byte> bytes, const std::string& nameForErrors, const std::string& layer) {
  MemoryBudget budget(nameForErrors, 0, Remedy::none);
  return decodeExrLayer(bytes, nameForErrors, layer, budget);
}

Image decodeExrLayer(std::span<const std::byte> bytes, const std::string& nameForErrors, const std::string& layer,
                     MemoryBudget& budget) {
  const Source source{bytes, nameForErrors};
  if (!isExr(source)) source.fail("not an OpenEXR file: it has no layers");
  try {
    return withExrFile(source, [&](Imf::MultiPartInputFile& file) {
      PartChannels found = findLayer(source, file, layer);
      keepColors(found.channels);
      if (found.channels.size() > 4)
        source.fail(fmt::format("the layer '{}' has {} channels; name a single channel such as '{}'", layer,
                                found.channels.size(), found.channels.front()));
      const Imf::Header& header = file.header(found.part);
      checkChannels(source, header, found.channels, kMaxImageBytes);
      budget.take(infoOf(header, found.channels.size()).byteCount());
      const TemporaryMemory temporary(budget, channelBytes(header, found.channels.size()));
      return toImage(readChannels(source, file, found.part, found.channels), header.displayWindow());
    });
  } catch (const std::bad_alloc&) {
    source.fail("not enough memory for the image");
  }
}

}  // namespace quintet::io
